"""Adaptive quadrature of the rendering equation along rays, from the local coefficients alone.

A ray is cut into panels. Each is summed up by its optical thickness and by the radiance that its own source sends to
its start, both from the same 16 Gauss-Legendre nodes: the running integral of sigma_t gives tau at every node. Two
neighbours compose as layers of paint do,

    tau = tau_1 + tau_2,    gain = gain_1 + exp(-tau_1) gain_2,

so a panel can be compared with its own halves. The difference is the error estimate, far above the error of the
halves, which replace their parent where it is too large. All rays are refined together, one call of the medium a round.

A user's function may jump where nobody says so. Halves can agree on a wrong value then, so its panels are looked at on their edges
too, and held to what one jump in a panel can cost (`jump_bound`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.blocks import in_blocks
from fogproof.analytic.arithmetic.budget import afford, budget, may_refine, of_bounded_variation
from fogproof.analytic.arithmetic.error_free import EPS, TINY, two_sum
from fogproof.analytic.arithmetic.panel_rule import NODES
from fogproof.analytic.geometry.rays import Thickness
from fogproof.analytic.media.breakpoints import breakpoints
from fogproof.analytic.media.coefficients import ROOM, Coefficients, coefficients
from fogproof.analytic.media.depth_panels import DepthPanels, joined, measured, starts_of, with_jumps_beside
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.kinds import given

TOLERANCE = 1e-13
"""Relative error aimed at; rounding may end above it, and says so."""

ROUNDS = 50
PANELS = 4096
"""Most panels of one ray; what is left undone by then stands in the error."""

FIRST = 8
"""Panels that an interval starts with if nobody has a closed form of what is in it."""

THICK, UNSEEN = 8.0, 1e-30
"""A panel thicker than this is halved, as long as more than that of its light arrives."""

BLOCK = 4096
"""Panels evaluated at a time."""

RAYS = 32_768
"""Rays refined together."""

SPARE = 16.0
"""Times as small as its share is what a jump would cost in a panel without one: halving a smooth one is cheap."""

SOURCE = "Gauss-Legendre quadrature, panel against its halves; composition as in Porter & Duff 1984"

SourceTerm = Callable[[Coefficients], np.ndarray]
"""Radiance gained per metre [W/(m^3 sr)] at points with these coefficients."""


class Along(NamedTuple):
    """Optical thickness of each ray and the radiance its sources send to its start, (n,) or (n, channels)."""

    tau: np.ndarray
    tau_error: np.ndarray
    gain: np.ndarray
    gain_error: np.ndarray


def thickness_by_quadrature(medium: AnyMedium, ray: Ray, channels: int | None) -> Thickness:
    """Return tau of a medium of which only the local coefficients are known, shape R or R + (channels,).

    Error: estimated from panels against their halves, plus rounding. A user's function may jump or kink once in any length of
    its `detail` (in an eighth of what the ray crosses, where it declares none); what is smaller cannot be seen.
    """
    along = integrate_along(medium, ray, lambda local: np.zeros_like(local.sigma_t), channels)
    shape = ray.shape if channels is None else (*ray.shape, channels)
    value, error = along.tau.reshape(shape), along.tau_error.reshape(shape)
    return Thickness(value, np.zeros(shape), error, "adaptive Gauss-Legendre 16", SOURCE)


def integrate_along(
    medium: AnyMedium,
    ray: Ray,
    source: SourceTerm,
    channels: int | None = None,
    tolerance: float = TOLERANCE,
    extinction: SourceTerm = lambda local: local.sigma_t,
) -> Along:
    """Return the optical thickness and the gain along the flattened rays, with estimated errors; `RAYS` of them at a time.

    source      the radiance gained per metre, from the local coefficients
    channels    how many channels the result has, the medium's own unless given
    extinction  what is integrated to the optical thickness [1/m]
    """
    origin, direction, length = ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3), ray.length.reshape(-1)

    def along(some: np.ndarray) -> Along:
        rays = Ray(origin[some], direction[some], length[some])
        return _along(medium, rays, source, channels, tolerance, extinction)

    return Along(*in_blocks(along, RAYS, np.arange(len(origin))))


def _along(
    medium: AnyMedium,
    ray: Ray,
    source: SourceTerm,
    channels: int | None,
    tolerance: float,
    extinction: SourceTerm,
) -> Along:
    """Return the same of rays (n,), all refined together."""
    origin, direction = ray.origin, ray.direction
    reach = np.max(np.abs(origin), axis=-1, initial=0.0)
    foreign = hasattr(medium, "detail")

    def look(which: np.ndarray, t: np.ndarray, moved: np.ndarray | float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        w = direction[which, None, :]
        local = coefficients(medium, origin[which, None, :] + t[..., None] * w + moved, w, channels)
        return extinction(local), np.broadcast_to(source(local), local.sigma_t.shape)

    def evaluate(which: np.ndarray, start: np.ndarray, width: np.ndarray) -> DepthPanels:
        blocks = [slice(i, i + BLOCK) for i in range(0, max(len(which), 1), BLOCK)]
        found = [measured(look, which[b], start[b], width[b], reach if foreign else None) for b in blocks]
        return DepthPanels(*(np.concatenate(columns) for columns in zip(*found, strict=True)))

    count = len(origin)
    with budget(count):
        panels = _refined(evaluate, evaluate(*_first(medium, ray)), count, tolerance)
        if foreign:
            panels = with_jumps_beside(look, panels, origin, direction)
    return _compose(panels, count, reach)


Evaluate = Callable[[np.ndarray, np.ndarray, np.ndarray], DepthPanels]
"""(rays (p,), starts (p,), widths (p,)) -> panels."""


def _refined(evaluate: Evaluate, panels: DepthPanels, count: int, tolerance: float) -> DepthPanels:
    """Return panels in place of these that hold their share of the error, as far as the budget goes."""
    done = panels._replace(**{name: column[:0] for name, column in panels._asdict().items()})
    for turn in range(ROUNDS):
        if not len(panels.ray):
            break
        if turn and not may_refine():
            panels = _left_undone(panels)
            break
        everything = joined(done, *_halved(evaluate, panels))
        bad = _too_wrong(everything, count, tolerance)
        panels = DepthPanels(*(column[bad] for column in everything))
        done = DepthPanels(*(column[~bad] for column in everything))
    return joined(done, panels)


def _halved(evaluate: Evaluate, panels: DepthPanels) -> list[DepthPanels]:
    """Return both halves of the panels and, where a jump stands out, what is before it, what holds it and what is after it."""
    ray, start, width = panels.ray, panels.start, panels.width
    low, high = start + panels.cuts[:, 0] * width, start + panels.cuts[:, 1] * width
    lone = np.flatnonzero(high > low)
    left, right = evaluate(ray, start, low - start), evaluate(ray, high, start + width - high)
    middle = evaluate(ray[lone], low[lone], (high - low)[lone])
    tau, gain = right.tau.copy(), right.gain.copy()
    with np.errstate(under="ignore"):
        gain[lone] = middle.gain + np.exp(-middle.tau) * gain[lone]
        tau[lone] += middle.tau
        tau_off = np.abs(left.tau + tau - panels.tau) / 2
        gain_off = np.abs(left.gain + np.exp(-left.tau) * gain - panels.gain) / 2
    tau_off[lone] = gain_off[lone] = 0.0  # what the jump is to blame for is known to the part that holds it
    parts = []
    for part, which in ((left, slice(None)), (middle, lone), (right, slice(None))):
        tau_error = np.maximum(tau_off[which], part.hidden[..., 0])
        gain_error = np.maximum(gain_off[which], part.hidden[..., 1])
        parts.append(part._replace(tau_error=tau_error, gain_error=gain_error))
    return parts


def _first(medium: AnyMedium, ray: Ray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the panels to begin with: between breaks, and no wider than the detail the medium declares."""
    edges = breakpoints(medium, ray)
    widths = np.diff(edges, axis=-1)
    which, column = np.nonzero(widths > 0)
    start, width = edges[which, column], widths[which, column]
    detail = getattr(medium, "detail", np.inf)
    pieces = FIRST if given(medium, ROOM, "thickness") is None or hasattr(medium, "detail") else 1
    parts = np.maximum(pieces, np.ceil(width / detail))
    afford(len(NODES) * np.bincount(which, parts).max(initial=0.0))
    parts = parts.astype(int)
    owner = np.repeat(np.arange(len(parts)), parts)
    step = np.arange(len(owner)) - np.repeat(np.cumsum(parts) - parts, parts)
    share = width[owner] / parts[owner]
    return which[owner], start[owner] + step * share, share


def _too_wrong(panels: DepthPanels, count: int, tolerance: float) -> np.ndarray:
    """Return which panels hold more than their share of the error that their ray may have."""
    rays, (first, number) = panels.ray, starts_of(panels.ray, count)
    before = np.cumsum(panels.tau, axis=0) - panels.tau
    with np.errstate(under="ignore", invalid="ignore"):
        seen = np.exp(-(before - before[first[rays]]))
        totals = []
        for x in (panels.tau, seen * panels.gain):
            total = np.zeros((count, *x.shape[1:]))
            np.add.at(total, rays, x)
            totals.append(total)
        share = tolerance / number[rays].reshape(-1, *[1] * (panels.tau.ndim - 1))
        bad = panels.tau_error > np.maximum(share * totals[0][rays], 8 * EPS * panels.tau)
        bad |= seen * panels.gain_error > np.maximum(share * totals[1][rays], 8 * EPS * seen * panels.gain)
        share = share / SPARE
        bad |= panels.hidden[..., 0] > np.maximum(share * totals[0][rays], 64 * EPS * panels.tau)
        bad |= seen * panels.hidden[..., 1] > np.maximum(share * totals[1][rays], 64 * EPS * seen * panels.gain)
        # Nodes that see nothing through a thick panel would find no gain in it, and their halves none either.
        glows = (panels.jumps[..., 1] > 0) | (panels.ends[..., 1, 0] > 0)
        bad |= glows & (panels.tau > THICK) & (seen > UNSEEN)
    bad = bad.reshape(len(bad), -1).any(axis=-1)
    return bad & (number[rays] < PANELS) & (panels.width > 4 * EPS * (panels.start + panels.width))


def _left_undone(panels: DepthPanels) -> DepthPanels:
    """Return the panels with the errors that their nodes allow, where no halves say how wrong they are."""
    width = panels.width.reshape(-1, *[1] * (panels.tau.ndim - 1))
    brightest = panels.ends[..., 1, 0] + panels.jumps[..., 1]
    tau_error = np.maximum(panels.tau_error, of_bounded_variation(width, panels.jumps[..., 0]))
    dimmed = np.minimum(panels.tau + tau_error, 1.0)
    rough = of_bounded_variation(width, panels.jumps[..., 1] + brightest * dimmed) + width * brightest * tau_error
    return panels._replace(tau_error=tau_error, gain_error=np.maximum(panels.gain_error, rough))


def _compose(panels: DepthPanels, count: int, reach: np.ndarray) -> Along:
    """Compose the panels of each ray from the camera on, with the errors and what rounding adds.

    A rounded position moves a value by at most the change of the coefficient there, so all of them together by the
    sum of its changes along the ray times EPS (|origin| + t); four times that allows for changes across the ray.
    """
    first, number = starts_of(panels.ray, count)
    rank = np.arange(len(panels.ray)) - first[panels.ray]
    tau, low, gain, tau_error, gain_error = (np.zeros((count, *panels.tau.shape[1:])) for _ in range(5))
    last = np.zeros((count, *panels.ends.shape[1:-1]))
    for step in range(number.max(initial=0)):
        now = np.flatnonzero(rank == step)
        r, p = panels.ray[now], DepthPanels(*(column[now] for column in panels))
        place = (4 * EPS * (reach[r] + p.start + p.width)).reshape(-1, *[1] * (p.jumps.ndim - 1))
        moved = place * (p.jumps + np.abs(p.ends[..., 0] - last[r]))
        with np.errstate(under="ignore"):
            seen = np.exp(-tau[r])
            gain[r] += seen * p.gain
            gain_error[r] += seen * (p.gain_error + p.gain * (tau_error[r] + 16 * EPS) + moved[..., 1])
            gain_error[r] += seen * p.gain * (p.tau_error + moved[..., 0])
        tau[r], rest = two_sum(tau[r], p.tau)
        low[r] += rest
        tau_error[r] += p.tau_error + 8 * EPS * p.tau + moved[..., 0]
        last[r] = p.ends[..., 1]
    gain_error = gain_error + EPS * (1 + number.reshape(-1, *[1] * (tau.ndim - 1))) * gain / 2
    return Along(tau + low, tau_error + TINY, gain, gain_error + TINY)
