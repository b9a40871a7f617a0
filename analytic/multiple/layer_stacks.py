"""Stacks of layers over a ground in discrete directions: what one number of nodes gives.

Every layer is doubled by itself, with the forward peak of its phase function taken out, and they are added from the top down.
"""

from __future__ import annotations

from functools import reduce
from typing import NamedTuple

import numpy as np

from fogproof.analytic.grounds import ROOM, GroundBeams, ground_brdf, ground_modes
from fogproof.analytic.multiple.adding import Stack, added, between, opaque, stack_of, vacuum
from fogproof.analytic.multiple.doubling import layer
from fogproof.analytic.multiple.scattering_arguments import seen_at
from fogproof.analytic.multiple.scattering_kernel import Scaled, fourier_medium, scaled
from fogproof.analytic.multiple.slab_by_doubling import MOMENTS
from fogproof.analytic.multiple.slab_directions import MODES, SEEN, Beams, Side, scattered_once, single_gain
from fogproof.analytic.multiple.slab_modes import quadrature
from fogproof.scene.grounds import Ground
from fogproof.scene.kinds import given
from fogproof.scene.phase import PhaseFunction

_TOGETHER = 96
"""Cosines of beams that one solution is asked for: as many as its nodes, or fewer, is what takes the least time."""


class LayerMedium(NamedTuple):
    """A layer that is neither empty nor endless: albedo, optical thickness, phase function, its moments, L_e [W/(m^2 sr)]."""

    albedo: float
    tau: float
    phase: PhaseFunction
    chi: np.ndarray
    emission: float


class Below(NamedTuple):
    """What lies under the lowest layer: a ground, or None, and its L_e [W/(m^2 sr)]."""

    ground: Ground | None
    emission: float


class StackDirections(NamedTuple):
    """Directions: nodes mu of weights w, cosines asked for, and pi times the modes of the ground between all of them."""

    mu: np.ndarray
    w: np.ndarray
    aside: np.ndarray
    reflects: np.ndarray | None


class Fluxes(NamedTuple):
    """What becomes of a beam from above, at each of the cosines asked for (v,).

    reflected    share that leaves upwards
    transmitted  share that arrives at the bottom, scattered or not and, over a ground, as often as it comes back
    emitted      radiance upwards of what glows
    """

    reflected: np.ndarray
    transmitted: np.ndarray
    emitted: np.ndarray


class Stacked(NamedTuple):
    """All layers, and what is below, at directions whose W^(1/2) is root (n,), of which those from `nodes` on are no nodes.

    forward, backward  of each layer, c p/2 between directions
    """

    layers: Stack
    below: Stack
    root: np.ndarray
    nodes: int
    balanced: np.ndarray
    forward: list[np.ndarray]
    backward: list[np.ndarray]


def fluxes(layers: list[LayerMedium], below: Below, mu0: np.ndarray, n: int) -> Fluxes:
    """Return what becomes of beams of cosines mu0 (v,) by n nodes."""
    if (low := _lower_half(mu0)) is not None:
        parts = [fluxes(layers, below, mu0[here], n) for here in (low, ~low)]
        return Fluxes(*(_merged(low, *found) for found in zip(*parts, strict=True)))
    slabs = _scaled(layers, n)
    cosines, where = np.unique(seen_at(mu0, _thinnest(slabs)), return_inverse=True)
    nodes = _nodes(slabs, below, cosines, n)
    stacked = _stacked(slabs, layers, below, nodes, np.zeros(1, int))
    root = stacked.root
    meeting = between(stacked.layers, stacked.below, root, stacked.balanced)
    total = added(stacked.layers, stacked.below, root, stacked.balanced)
    passed = (root @ meeting.down) / root + stacked.layers.ray
    found = (total.R @ root) / root, passed, total.lost[..., 1] / root
    return Fluxes(*(x[0, stacked.nodes :][where.ravel()] for x in found))


def once(layers: list[LayerMedium], below: Below, beams: Beams, side: Side, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return radiance per irradiance [1/sr] after one scattering or reflection, from the densities themselves, and its error."""
    slabs = _scaled(layers, n)
    value, error = np.zeros_like(beams.mu0), np.zeros_like(beams.mu0)
    for i, one in enumerate(layers):
        single, its_error = scattered_once(one.albedo, beams, one.phase, side)
        along = _alone(slabs, i, beams.mu0, beams.mu, side) / (1 - one.albedo * float(one.chi[MOMENTS * n]))
        value, error = value + single * along, error + its_error * along
    if below.ground is not None and side == "reflected":
        brdf, its_error = ground_brdf(below.ground, GroundBeams(*beams))
        along = _past(slabs, beams.mu0, beams.mu)
        value, error = value + brdf * along, error + its_error * along
    return value, error


def more_than_once(
    layers: list[LayerMedium], below: Below, beams: Beams, side: Side, n: int, first: np.ndarray
) -> np.ndarray:
    """Return radiance per irradiance [1/sr] after two scatterings or reflections and more (v,); `first` is that after one."""
    if (low := _lower_half(beams.mu0, beams.mu)) is not None:
        halves = [(Beams(*(x[here] for x in beams)), first[here]) for here in (low, ~low)]
        return _merged(low, *(more_than_once(layers, below, some, side, n, its_first) for some, its_first in halves))
    slabs = _scaled(layers, n)
    cosines, where = np.unique(
        seen_at(np.concatenate([beams.mu0, beams.mu]), _thinnest(slabs), 1e-13), return_inverse=True
    )
    came, goes = np.split(where.ravel(), 2)
    nodes = _nodes(slabs, below, cosines, n)
    total = np.zeros_like(beams.mu0)
    for start in range(0, MOMENTS * n, MODES):
        orders = np.arange(start, min(start + MODES, MOMENTS * n))
        part = _kernel(_stacked(slabs, layers, below, nodes, orders), slabs, nodes, orders, side)[:, goes, came]
        twice = np.where(orders == 0, 1.0, 2.0)[:, None] * np.cos(orders[:, None] * beams.azimuth)
        total += np.sum(part * twice, axis=0)
        if np.all(np.abs(part[-1]) <= SEEN * (np.abs(total) + np.pi * first)):
            break
    return total / np.pi


def _lower_half(*cosines: np.ndarray) -> np.ndarray | None:
    """Return which beams lie in the lower half of the cosines that differ most often, None if all are few enough together.

    Matrices between all directions grow with the square of their number; beams know nothing of each other.
    """
    each = [np.unique(found) for found in cosines]
    if sum(map(len, each)) <= _TOGETHER:
        return None
    most = int(np.argmax([len(found) for found in each]))
    return np.asarray(cosines[most] < each[most][len(each[most]) // 2])


def _merged(low: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Return what was found of both halves in one array (v,)."""
    found = np.empty(low.shape)
    found[low], found[~low] = lower, upper
    return found


def _kernel(
    stacked: Stacked, slabs: list[Scaled], nodes: StackDirections, orders: np.ndarray, side: Side
) -> np.ndarray:
    """Return pi times the modes between the directions aside (m, v, v), less what met something once."""
    aside, cosines = slice(stacked.nodes, None), nodes.aside
    root = stacked.root[aside]
    if side == "reflected":
        matrix = added(stacked.layers, stacked.below, stacked.root, stacked.balanced).R
    else:
        matrix = between(stacked.layers, stacked.below, stacked.root, stacked.balanced).down
    found = matrix[:, aside, aside] / (root[:, None] * root)
    kernels = stacked.backward if side == "reflected" else stacked.forward
    for i, kernel in enumerate(kernels):
        found -= kernel[:, aside, aside] / 2 * _alone(slabs, i, cosines, cosines[:, None], side)
    if nodes.reflects is not None and side == "reflected":
        found -= _modes(nodes.reflects, orders)[:, aside, aside] * _past(slabs, cosines, cosines[:, None])
    return found


def _scaled(layers: list[LayerMedium], n: int) -> list[Scaled]:
    """Return the layers without their forward peaks."""
    return [scaled(np.array([x.albedo]), np.array([x.tau]), x.chi[: MOMENTS * n + 1]) for x in layers]


def _thinnest(slabs: list[Scaled]) -> float:
    return min(float(slab.tau[0]) for slab in slabs)


def _nodes(slabs: list[Scaled], below: Below, aside: np.ndarray, n: int) -> StackDirections:
    """Return the directions of a solution."""
    whole = sum(float(slab.tau[0]) for slab in slabs)
    mu, w = quadrature(min(_thinnest(slabs), 10 * float(aside.min())), n, weight=whole)
    reflects = None if below.ground is None else ground_modes(below.ground, np.concatenate([mu, aside]))
    return StackDirections(mu, w, aside, reflects)


def _modes(every: np.ndarray, orders: np.ndarray) -> np.ndarray:
    """Return some of the modes of a ground; what is beyond the last is nothing."""
    inside = orders < len(every)
    return every[np.where(inside, orders, 0)] * inside[:, None, None]


def _stacked(
    slabs: list[Scaled], layers: list[LayerMedium], below: Below, nodes: StackDirections, orders: np.ndarray
) -> Stacked:
    """Return all layers on one another, and what is below them."""
    media = [fourier_medium(slab, nodes.mu, nodes.w, nodes.aside, orders) for slab in slabs]
    root, balanced = np.sqrt(2 * media[0].mu * media[0].w), orders == 0
    stacks = [
        stack_of(layer(medium, np.full(len(orders), slab.tau[0])), medium.absorbed, np.array([1.0, one.emission]))
        for medium, slab, one in zip(media, slabs, layers, strict=True)
    ]
    whole_stack = reduce(lambda upper, lower: added(upper, lower, root, balanced), stacks)
    under = _ground(below, media[0].mu, root, nodes.reflects, orders)
    kernels = [m.forward for m in media], [m.backward for m in media]
    return Stacked(whole_stack, under, root, len(nodes.mu), balanced, *kernels)


def _ground(below: Below, mu: np.ndarray, root: np.ndarray, reflects: np.ndarray | None, orders: np.ndarray) -> Stack:
    """Return what is below as a stack that nothing passes, or as vacuum."""
    if below.ground is None or reflects is None:
        return vacuum(len(orders), len(mu), 2)
    R = root[:, None] * _modes(reflects, orders) * root
    own = given(below.ground, ROOM, "absorbed")
    share = 1 - (root * reflects[0]) @ root if own is None else own(below.ground, mu)
    lost = np.where((orders == 0)[:, None], np.maximum(share, 0.0) * root, 0.0)
    return opaque(R, lost[..., None] * np.array([1.0, below.emission]))


def _alone(slabs: list[Scaled], i: int, mu0: np.ndarray, mu: np.ndarray, side: Side) -> np.ndarray:
    """Return what one scattering in layer i is worth, between directions that broadcast: the way there, in it and from it."""
    tau = [float(slab.tau[0]) for slab in slabs]
    above, under = sum(tau[:i]), sum(tau[i + 1 :])
    there = above * (1 / mu0 + 1 / mu) if side == "reflected" else above / mu0 + under / mu
    return np.exp(-there) * single_gain(tau[i], mu0, mu, side)


def _past(slabs: list[Scaled], mu0: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Return what passes all layers straight down and up again."""
    return np.exp(-sum(float(slab.tau[0]) for slab in slabs) * (1 / mu0 + 1 / mu))
