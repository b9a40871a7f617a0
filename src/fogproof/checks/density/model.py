"""What a claimed density says: its integral over every part of the domain, by quadrature that looks for what it may have missed.

Adaptive quadrature trusts its nodes, and a black box may hide a peak or a hole between them. So the polynomials that it leaves
behind are compared with the density where it was not asked: on a line at 32 probes a panel, at both sides of every panel's end
and at the points of a pilot sample; on a plane at the points of the pilot and beside the corners of boxes. Where they differ,
the boxes are cut around the place and integrated again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fogproof.checks.density.charts import Axis, Chart
from fogproof.checks.density.curve import TO_COEFFICIENTS, curve_of_line, legendre
from fogproof.checks.density.quadrature import NODES, Leaves, integrate, refine, replaced, split

Density = Callable[[np.ndarray], np.ndarray]

_PANELS = 512  # between quantiles of the pilot
_SPREAD = 32  # more panels, of equal width: they see what the pilot of a wrong sampler never visits
_PLANE = 8  # boxes along each axis of a plane to begin with
_PROBES = 32  # points of a panel at which its polynomial is compared with the density
_POINTS = 4096  # of the pilot that are compared on a plane
_FIRST = 200_000  # evaluations on a plane, after which it shows whether more would help
_HOPELESS = 1e-4  # error after them that only a density which jumps along a curve leaves
_BESIDE = 1e-7  # of a box, from its corners
_ROUNDS = 12  # of looking and cutting
_MOST_CUT = 256  # boxes cut in one round of looking
_RELATIVE = 1e-3  # a polynomial that is wrong by less misses no feature


@dataclass(frozen=True)
class Effort:
    """How hard to try: wanted error of the integral, most evaluations, relative rounding noise of the density."""

    tolerance: float
    budget: int
    noise: float


def integrated(chart: Chart, density: Density, pilot: np.ndarray, effort: Effort) -> Leaves:
    """Return boxes that fill the chart, with the density (m, k) -> (m,) known on each; `pilot` (n, k) are coordinates."""
    return _line(chart, density, pilot[:, 0], effort) if len(chart.axes) == 1 else _plane(chart, density, pilot, effort)


def second_view(chart: Chart, density: Density, pilot: np.ndarray, effort: Effort) -> Leaves:
    """Return other boxes with the same density, none of their first edges but that at 0 in common with those of `integrated`."""
    if len(chart.axes) == 1:
        along = np.sort(pilot[:, 0])
        inner = _quantiles(along, (np.arange(_PANELS // 2) + 0.5) / (_PANELS // 2))
        ends = inner, _shifted(chart.axes[0], _SPREAD), chart.axes[0].breaks, _zero(chart.axes[0])
        breaks = np.unique(np.concatenate(ends))
        low, high = breaks[:-1, None], breaks[1:, None]
    else:
        low, high = corners(tuple(np.union1d(_shifted(axis, _PLANE), axis.breaks) for axis in chart.axes))
    leaves = integrate(density, low, high, effort.tolerance, effort.budget, effort.noise)
    if len(chart.axes) == 1:
        return looked_at(density, leaves, along, effort)
    return _looked_at_corners(density, looked_at_plane(density, leaves, pilot[-_POINTS:], effort), effort)


def _shifted(axis: Axis, count: int) -> np.ndarray:
    """Return the ends of an axis and inner edges that no whole number of equal parts has."""
    inner = (np.arange(count - 1) + 2**-0.5) / (count - 0.6)
    return np.concatenate([[axis.low], axis.low + (axis.high - axis.low) * inner, [axis.high]])


def _line(chart: Chart, density: Density, pilot: np.ndarray, effort: Effort) -> Leaves:
    low, high = chart.axes[0].low, chart.axes[0].high
    pilot = np.sort(pilot)
    inner = _quantiles(pilot, np.arange(_PANELS + 1) / _PANELS)
    inner = inner[(inner > low) & (inner < high)]
    ends = inner, np.linspace(low, high, _SPREAD + 1), chart.axes[0].breaks, _zero(chart.axes[0])
    breaks = np.unique(np.concatenate(ends))
    leaves = integrate(density, breaks[:-1, None], breaks[1:, None], effort.tolerance, effort.budget, effort.noise)
    leaves = looked_at(density, leaves, pilot, effort)
    probes = np.concatenate([[1e-9], (np.arange(_PROBES) + 0.5) / _PROBES, [1 - 1e-9]])
    checked = np.empty(0)
    for _ in range(_ROUNDS):
        fresh = ~np.isin(leaves.low[:, 0], checked)
        left, right = leaves.low[fresh, 0], leaves.high[fresh, 0]
        points = left[:, None] + (right - left)[:, None] * probes
        checked = leaves.low[:, 0]
        nodes = np.where(np.isfinite(leaves.values[fresh]), leaves.values[fresh], 0.0)
        polynomial = nodes @ TO_COEFFICIENTS @ legendre(2 * probes - 1, len(NODES) - 1)
        value, width = density(points.ravel()[:, None]), np.repeat(right - left, len(probes))
        if not _missed(value, polynomial.ravel(), width, effort).any():
            break
        finer = looked_at(density, leaves, np.sort(points.ravel()), effort, rounds=1)
        if finer is leaves:
            break
        leaves = finer
    return leaves


def _zero(axis: Axis) -> np.ndarray:
    """Return the coordinate of 0, if it lies inside a line: a pole there is as narrow as no other can be."""
    at = axis.hidden(np.zeros(1))
    return at[(at > axis.low) & (at < axis.high)]


def _quantiles(sorted_points: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """Return where so many shares of the points lie below, none of no points."""
    n = len(sorted_points)
    return np.interp(shares * (n - 1), np.arange(n), sorted_points) if n else np.empty(0)


def looked_at(density: Density, leaves: Leaves, points: np.ndarray, effort: Effort, rounds: int = _ROUNDS) -> Leaves:
    """Compare one-dimensional leaves with the density at sorted points (n,); return them cut finer where they differ."""
    if len(points) == 0:
        return leaves
    value = density(points[:, None])
    for _ in range(rounds):
        curve = curve_of_line(leaves)
        owner = np.clip(np.searchsorted(curve.breaks, points, side="right") - 1, 0, len(curve.breaks) - 2)
        width = curve.breaks[owner + 1] - curve.breaks[owner]
        missed = _missed(value, curve.density(points), width, effort)
        if not missed.any():
            break
        miss = np.abs(value - curve.density(points))[missed] * width[missed]
        order = np.lexsort((-miss, owner[missed]))
        boxes, first = np.unique(owner[missed][order], return_index=True)
        worst = np.argsort(miss[order][first])[::-1][:_MOST_CUT]
        boxes, around = boxes[worst], points[missed][order][first][worst]
        by_place = np.argsort(leaves.low[:, 0])
        low, high = _cut_around(curve.breaks[boxes], curve.breaks[boxes + 1], around)
        finer = replaced(density, leaves, by_place[boxes], low[:, None], high[:, None])
        finer = refine(density, finer, effort.tolerance, effort.budget, effort.noise)
        if len(finer.low) == len(leaves.low) or finer.evaluations > effort.budget:
            return finer
        leaves = finer
    return leaves


def _missed(value: np.ndarray, polynomial: np.ndarray, volume: np.ndarray, effort: Effort) -> np.ndarray:
    """Return where a density and its polynomial differ by more than noise, over a volume that could matter."""
    with np.errstate(invalid="ignore"):
        gap = np.abs(value - polynomial)
        larger = np.maximum(np.abs(value), np.abs(polynomial))
        return (gap > (_RELATIVE + 64 * effort.noise) * larger) & (gap * volume > effort.tolerance)


def _cut_around(left: np.ndarray, right: np.ndarray, around: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return ends of panels that shrink geometrically towards a point in each of the given panels."""
    steps = (right - left)[:, None] * 4.0 ** -np.arange(1, 14)
    edges = np.concatenate(
        [left[:, None], around[:, None] - steps, around[:, None], around[:, None] + steps, right[:, None]], axis=1
    )
    edges = np.sort(np.clip(edges, left[:, None], right[:, None]), axis=1)
    low, high = edges[:, :-1].ravel(), edges[:, 1:].ravel()
    return low[low < high], high[low < high]


def _plane(chart: Chart, density: Density, pilot: np.ndarray, effort: Effort) -> Leaves:
    low, high = corners(tuple(_cuts(axis) for axis in chart.axes))
    leaves = integrate(density, low, high, effort.tolerance, min(_FIRST, effort.budget), effort.noise)
    if not leaves.total_error <= _HOPELESS:
        return leaves
    leaves = refine(density, leaves, effort.tolerance, effort.budget, effort.noise)
    return _looked_at_corners(density, looked_at_plane(density, leaves, pilot[:_POINTS], effort), effort)


def _looked_at_corners(density: Density, leaves: Leaves, effort: Effort) -> Leaves:
    """Compare leaves with the density beside their own corners; return them cut finer where they differ.

    A lobe at a pole fills a corner of each box that meets there, narrower than the way to its first node.
    """
    width = leaves.high - leaves.low
    inwards = _BESIDE * np.array([(i, j) for i in (1, -1) for j in (1, -1)])
    ends = np.where(inwards[:, None] > 0, leaves.low, leaves.high)
    points = (ends + inwards[:, None] * width).reshape(-1, 2)
    owner = np.tile(np.arange(len(leaves.low)), len(inwards))
    missed = _missed(density(points), plane_density(leaves, owner, points), np.prod(width, axis=1)[owner], effort)
    points = points[missed]
    return looked_at_plane(density, leaves, points[:: max(len(points) // _POINTS, 1)][:_POINTS], effort)


def _cuts(axis: Axis) -> np.ndarray:
    """Return where the first boxes of an axis begin and end."""
    if len(axis.breaks):
        return np.concatenate([[axis.low], axis.breaks, [axis.high]])
    return np.linspace(axis.low, axis.high, _PLANE + 1)


def looked_at_plane(density: Density, leaves: Leaves, points: np.ndarray, effort: Effort) -> Leaves:
    """Compare two-dimensional leaves with the density at points (n, 2); return them cut finer where they differ."""
    value = density(points) if len(points) else np.empty(0)
    for _ in range(_ROUNDS):
        if len(points) == 0 or leaves.evaluations > effort.budget:
            break
        owner = _owners(leaves, points)
        found = owner >= 0
        volume = np.prod(leaves.high - leaves.low, axis=1)[owner]
        missed = found & _missed(value, plane_density(leaves, owner, points), volume, effort)
        points, value = points[missed], value[missed]
        if len(points) == 0:
            break
        cut = np.unique(owner[missed])[:_MOST_CUT]
        leaves = split(density, leaves, cut)
        leaves = refine(density, leaves, effort.tolerance, effort.budget, effort.noise)
    return leaves


def unknown(density: Density, leaves: Leaves, points: np.ndarray, effort: Effort) -> np.ndarray:
    """Return (n,) at which points (n, k) the density is not as the polynomials have it."""
    value = density(points)
    if points.shape[1] == 1:
        curve = curve_of_line(leaves)
        owner = np.clip(np.searchsorted(curve.breaks, points[:, 0], side="right") - 1, 0, len(curve.breaks) - 2)
        return _missed(value, curve.density(points[:, 0]), np.diff(curve.breaks)[owner], effort)
    owner = _owners(leaves, points)
    volume = np.prod(leaves.high - leaves.low, axis=1)[owner]
    return (owner < 0) | _missed(value, plane_density(leaves, owner, points), volume, effort)


def _owners(leaves: Leaves, points: np.ndarray) -> np.ndarray:
    """Return (n,) the index of the box that holds each point (n, 2), -1 where none does."""
    x, y = points[:, :1], points[:, 1:]
    inside = (x >= leaves.low[:, 0]) & (x <= leaves.high[:, 0])
    inside &= y >= leaves.low[:, 1]
    inside &= y <= leaves.high[:, 1]
    return np.where(inside.any(axis=1), inside.argmax(axis=1), -1)


def plane_density(leaves: Leaves, owner: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return (n,) the polynomials of the owning boxes (n,) at points (n, 2)."""
    if len(points) == 0:
        return np.empty(0)
    order = np.argsort(owner, kind="stable")
    sorted_owner = owner[order]
    low, high = leaves.low[sorted_owner], leaves.high[sorted_owner]
    s = np.clip((2 * points[order] - low - high) / (high - low), -1, 1)
    p, q = legendre(s[:, 0], len(NODES) - 1), legendre(s[:, 1], len(NODES) - 1)
    starts = np.flatnonzero(np.diff(sorted_owner, prepend=sorted_owner[0] - 1))
    coefficients = TO_COEFFICIENTS.T @ leaves.values[sorted_owner[starts]] @ TO_COEFFICIENTS
    result = np.empty(len(points))
    for each, start, end in zip(coefficients, starts, [*starts[1:], len(points)], strict=True):
        result[start:end] = np.einsum("ij,ij->j", each.T @ p[:, start:end], q[:, start:end])
    unsorted = np.empty(len(points))
    unsorted[order] = result
    return unsorted


def corners(edges: tuple[np.ndarray, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Return the (m, k) lower and upper corners of all cells of a grid, the last axis running fastest."""
    low, high = (np.meshgrid(*ends, indexing="ij") for ends in ([e[:-1] for e in edges], [e[1:] for e in edges]))
    return tuple(np.stack([g.ravel() for g in grid], axis=-1) for grid in (low, high))  # type: ignore[return-value]
