"""Slabs of any phase function, by doubling: how many nodes and moments it takes, and what the error is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.double_double import divide, pair
from fogproof.analytic.arithmetic.error_free import EPS, TINY, exp_minus
from fogproof.analytic.multiple.doubling import layer
from fogproof.analytic.multiple.scattering_arguments import DEEPEST, seen_at
from fogproof.analytic.multiple.scattering_kernel import Scaled, medium, scaled
from fogproof.analytic.multiple.slab_by_modes import Quantity
from fogproof.analytic.multiple.slab_modes import quadrature
from fogproof.analytic.phase.functions import phase_legendre_moments
from fogproof.scene.phase import PhaseFunction

LEVELS = (14, 20, 28, 40)
"""Half the number of nodes of a solution: the next ones are used where the last two differ."""

PEAKED = (56, 80, 112, 160)
"""The next ones, for moments that fall exponentially, and to less than `REACHED` at the last of them."""

REACHED, SURE = 0.1, 1e-3
"""Moment that the forward share may have at the last level, and from which on two solutions tell the error."""

ENOUGH_OF_PEAKED = 1e-11
"""Relative difference with which the finer one of those is taken."""

MOMENTS = 3
"""Moments for each of these: P_l is integrated as well as the radiance is."""

CUT = 1e-9
"""Moment that is not seen if it is cut off."""

SLOW = 0.05
"""What is left of moments at the end of those at hand, in terms of half way, that decay like a power and not an exponential."""

POWER, SAFETY = 1.0, 3.0
"""Then errors fall at least like n^-POWER with the number of nodes, but differences change their signs: all of them count."""

ENOUGH = 2e-13
"""Relative difference of two solutions with which the finer one is taken."""

ROUNDING = 64 * EPS
"""What rounding adds to the error, relative, and 4 eps for each factor e below 1."""

BLOCK = 65_536
"""Numbers in the matrices evaluated at a time: they stay in the cache."""

VIEWS = 32
"""Directions looked from at a time."""

FAINT, THINNEST = 1e-30, 1e-200
"""Albedo and thickness below which everything scattered (for the thickness, or absorbed) is proportional to them."""


class LayerMoments(NamedTuple):
    """chi_0 …, and what a phase function whose first moments are off by their errors differs by, integrated over directions.

    By Parseval's theorem that is at most the root of the sum of (2 l + 1) error_l^2.
    """

    chi: np.ndarray
    change: np.ndarray


@lru_cache(maxsize=32)
def phase_moments(phase: PhaseFunction, finest: int | None = None) -> LayerMoments:
    """Return as many moments as the finest solution needs, of `LEVELS` unless it is given."""
    moments = phase_legendre_moments(phase, MOMENTS * (finest or LEVELS[-1]))
    weight = 2 * np.arange(len(moments.value)) + 1
    with np.errstate(under="ignore"):
        return LayerMoments(moments.value, np.sqrt(np.cumsum(weight * moments.error**2)))


def is_isotropic(phase: PhaseFunction) -> bool:
    """Return whether all moments of a phase function vanish, exactly, but the first."""
    moments = phase_moments(phase)
    return not np.any(moments.chi[1:]) and moments.change[-1] == 0


def _first(chi: np.ndarray) -> int:
    """Return the first level worth a solution: the one before that where what is cut off would no longer be seen."""
    if decays_slowly(chi):
        return 0
    seen = [abs(float(chi[MOMENTS * n])) > CUT for n in LEVELS]
    return max(0, min(sum(seen), len(LEVELS) - 1) - 1)


def decays_slowly(chi: np.ndarray) -> bool:
    """Return whether the moments fall so slowly that two solutions do not tell the error: kinks, peaks, singularities."""
    sixth = len(chi) // 6
    last, half = (float(np.max(np.abs(chi[end - sixth : end]))) for end in (len(chi), len(chi) // 2))
    return last > CUT and last > SLOW * half


def levels_for(phases: Sequence[PhaseFunction]) -> tuple[list[LayerMoments], tuple[int, ...]]:
    """Return the moments of phase functions and the levels worth a solution of all of them together, the coarsest first."""
    moments = [phase_moments(phase) for phase in phases]
    peaked = [phase for phase, its in zip(phases, moments, strict=True) if abs(float(its.chi[-1])) > CUT]
    if peaked and all(_tamed(phase) for phase in peaked):
        return [phase_moments(phase, PEAKED[-1]) for phase in phases], (*LEVELS[2:], *PEAKED)
    return moments, LEVELS[
        min(_first(its.chi) for its in moments) if peaked else max(_first(its.chi) for its in moments) :
    ]


def _tamed(phase: PhaseFunction) -> bool:
    """Return whether moments fall exponentially, and the finest level meets the last that matters."""
    more = phase_moments(phase, PEAKED[-1])
    return _exponential(phase_moments(phase).chi) and abs(float(more.chi[-1])) < REACHED and _exponential(more.chi)


def _exponential(chi: np.ndarray) -> bool:
    """Return whether the moments fall at least as an exponential does: as much again over as many more of them."""
    sixth = len(chi) // 6
    quarter, half, last = (
        float(np.max(np.abs(chi[end - sixth : end]))) for end in (len(chi) // 4, len(chi) // 2, len(chi))
    )
    return 0 < last * quarter**1.5 < half**2.5 * (1 + 1e-9)


def doubled_values(
    c: np.ndarray, tau: np.ndarray, mu0: np.ndarray | None, phase: PhaseFunction, quantity: Quantity
) -> tuple[np.ndarray, np.ndarray]:
    """Return the quantity and its error for albedos, thicknesses and cosines (v,); for diffuse light if mu0 is None."""
    (moments,), levels = levels_for([phase])
    whole, tau = tau, np.minimum(tau, DEEPEST)
    beam, mu0 = mu0, None if mu0 is None else seen_at(mu0, tau)
    pairs, which = np.unique(np.stack([c, tau], axis=1), axis=0, return_inverse=True)
    which = which.reshape(len(c))
    value, error = np.zeros(c.shape), np.zeros(c.shape)
    todo = np.arange(len(c))
    before: list[tuple[int, np.ndarray]] = []
    falls = len(moments.chi) > MOMENTS * LEVELS[-1] + 1
    slow = not falls and decays_slowly(moments.chi)
    with np.errstate(under="ignore"):
        for n in levels:
            if not len(todo):
                break
            found, collisions = _solution(pairs, which, mu0, moments.chi, quantity, todo, n)
            smaller = np.abs(np.log(np.clip(found, TINY, 1)))
            scatterings = c[todo] * collisions
            change = moments.change[MOMENTS * n] * scatterings
            if quantity == "transmitted":  # what passes a deep slab changes with the phase function in relative terms
                change = np.minimum(change, moments.change[MOMENTS * n] * 10 * (1 + scatterings + smaller) * found)
            rounding = (ROUNDING + 4 * EPS * smaller) * np.abs(found) + change
            if not before:
                before.append((n, found))
                continue
            difference = np.abs(found - before[-1][1])
            if slow or (falls and abs(moments.chi[MOMENTS * n]) > SURE):
                difference = np.max([SAFETY * (m / n) ** POWER * np.abs(found - f) for m, f in before], axis=0)
            value[todo], error[todo] = found, difference + rounding + 2 * TINY
            if beam is not None:  # both so small that their quotient is lost where tau is raised to THINNEST
                error[todo] += (tau[todo] < THINNEST) & (beam[todo] < 1e16 * tau[todo])
            enough = ENOUGH_OF_PEAKED if n >= PEAKED[0] else ENOUGH
            more = difference > np.maximum(enough * np.abs(found), rounding)
            todo, before = todo[more], [(m, f[more]) for m, f in [*before, (n, found)]]
        if quantity == "transmitted" and beam is not None:
            straight, its_error = exp_minus(*divide(pair(whole), pair(beam)))
            alone = c == 0
            value, error = np.where(alone, straight, value), np.where(alone, its_error, error)
        if quantity == "absorbed":
            nothing = (c == 1) | (tau == 0)
            value, error = np.where(nothing, 0.0, value), np.where(nothing, 0.0, error)
        if quantity == "reflected":
            nothing = (c == 0) | (tau == 0)
            value, error = np.where(nothing, 0.0, value), np.where(nothing, 0.0, error)
        if quantity == "transmitted":
            thicker = np.maximum(whole, TINY)
            value = np.where(whole > tau, value * (tau / thicker), value)
            error = np.where(whole > tau, error * (tau / thicker) + TINY, error)
    return value, error


def _solution(
    pairs: np.ndarray,
    which: np.ndarray,
    mu0: np.ndarray | None,
    chi: np.ndarray,
    quantity: Quantity,
    todo: np.ndarray,
    n: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Return what nodes of that number give for the elements `todo`, and the mean number of collisions; both (v,)."""
    value, collisions = np.empty((2, len(todo)))
    needed, mine = np.unique(which[todo], return_inverse=True)
    smallest = np.full(len(needed), 1.0)
    if mu0 is not None:
        np.minimum.at(smallest, mine, mu0[todo])
    albedo, thick = np.maximum(pairs[needed, 0], FAINT), np.maximum(pairs[needed, 1], THINNEST)
    slabs = scaled(albedo, thick, chi[: MOMENTS * n + 1])
    thinner = pairs[needed, 1] / thick
    fewer = thinner * (pairs[needed, 0] / albedo)
    panels = np.ceil(-np.log(np.clip(np.minimum(slabs.tau, 10 * smallest) * 3, 1e-20, 1)) / math.log(6))
    for kind in np.unique(panels):
        alike = np.flatnonzero(panels == kind)
        tau = slabs.tau[alike]
        mu, w = quadrature(float(min(tau.min(), 10 * smallest[alike].min())), n, weight=float(tau.max()))
        size = max(1, BLOCK // len(mu) ** 2)
        for start in range(0, len(alike), size):
            block = alike[start : start + size]
            position = np.full(len(needed), -1)
            position[block] = np.arange(len(block))
            here = np.flatnonzero(position[mine] >= 0)
            some = slabs._replace(albedo=slabs.albedo[block], absorbed=slabs.absorbed[block], tau=slabs.tau[block])
            less = (thinner if quantity == "absorbed" else fewer)[block, None]
            if mu0 is None:
                seen = _seen(some, mu, w, np.empty(0), less, quantity)
                diffuse = 2 * w * mu
                result = [x @ diffuse for x in seen]
                for target, found in zip((value, collisions), result, strict=True):
                    target[here] = found[position[mine[here]]]
                continue
            cosines, view = np.unique(mu0[todo[here]], return_inverse=True)
            for first in range(0, len(cosines), VIEWS):
                seen = _seen(some, mu, w, cosines[first : first + VIEWS], less, quantity)
                asked = (view >= first) & (view < first + VIEWS)
                there = here[asked]
                at = position[mine[there]], len(mu) + view[asked] - first
                value[there], collisions[there] = seen[0][at], seen[1][at]
    return value, collisions * thinner[mine]


def _seen(
    slabs: Scaled, mu: np.ndarray, w: np.ndarray, aside: np.ndarray, less: np.ndarray, quantity: Quantity
) -> tuple[np.ndarray, np.ndarray]:
    """Return the quantity at nodes and at directions aside, and the mean number of collisions, (b, n) each."""
    between = medium(slabs, mu, w, aside)
    found = layer(between, slabs.tau)
    root = np.sqrt(2 * between.mu * between.w)
    glow = found.glow / root
    if quantity == "reflected":
        value = less * ((found.R @ root) / root)
    elif quantity == "transmitted":
        value = less * ((found.T @ root) / root) + found.ray
    else:
        value = less * slabs.absorbed[:, None] * glow
    return value, glow
