"""The cells of a density that was integrated: edges at its quantiles, and the probability of each cell with its error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fogproof.checks.density.charts import Axis, Chart
from fogproof.checks.density.curve import (
    Curve,
    coefficients_of,
    curve_along,
    curve_of_line,
    error_along,
    legendre,
    partial_error,
)
from fogproof.checks.density.grid import COARSE, FINEST_PLANE, Grid, GridPlane, Marginal, cells_wanted
from fogproof.checks.density.lookup import Lookup
from fogproof.checks.density.quadrature import NODES, Leaves

_INDEPENDENT = 1e-4  # axes are independent if no coarse cell differs by more than this share


def grid_of(chart: Chart, leaves: Leaves, samples: int) -> Grid:
    """Return the cells for up to `samples` samples of the density that the leaves hold."""
    cells = cells_wanted(samples, len(chart.axes))
    edges = []
    for axis, curve in zip(chart.axes, _curves(leaves), strict=True):
        inner = curve.quantiles(np.arange(1, cells) / cells)
        counted = np.maximum.accumulate(axis.counted(np.concatenate([[axis.low], inner, [axis.high]])))
        distinct = np.append(True, np.diff(counted) > 0)
        if not distinct[-1]:
            distinct[np.flatnonzero(distinct)[-1]], distinct[-1] = False, True
        edges.append(counted[distinct])
    return _filled(chart, leaves, edges, samples)


def refilled(grid: Grid, chart: Chart, leaves: Leaves, samples: int) -> Grid:
    """Return the same cells with the probabilities of better known leaves."""
    new = _filled(chart, leaves, [m.edges for m in grid.marginals], samples)
    marginals = zip(new.marginals, grid.marginals, strict=True)
    plane = (
        new.plane
        if new.plane is None or grid.plane is None
        else replace(new.plane, along=grid.plane.along, across=grid.plane.across)
    )
    return Grid(tuple(replace(m, blur=before.blur) for m, before in marginals), plane)


def _filled(chart: Chart, leaves: Leaves, edges: list[np.ndarray], samples: int) -> Grid:
    marginals = tuple(
        _marginal(axis, curve, e, error_along(leaves, k, axis.uncounted(e)))
        for k, (axis, curve, e) in enumerate(zip(chart.axes, _curves(leaves), edges, strict=True))
    )
    return Grid(marginals, None if len(edges) == 1 else _plane(chart, leaves, marginals, samples))


def _curves(leaves: Leaves) -> list[Curve]:
    return [curve_of_line(leaves)] if leaves.low.shape[1] == 1 else [curve_along(leaves, axis) for axis in (0, 1)]


def _marginal(axis: Axis, curve: Curve, edges: np.ndarray, error: tuple[np.ndarray, np.ndarray]) -> Marginal:
    """Return the marginal with the given edges of its cells, in the counted coordinate."""
    before, at_edge = error
    t = axis.uncounted(edges)
    total = curve.total if curve.total > 0 else 1.0
    cdf = np.clip(np.maximum.accumulate(curve.cdf(t)) / total, 0, 1)
    cdf[0], cdf[-1] = 0.0, 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        shown = axis.shown(t)

    def at(counted: np.ndarray) -> np.ndarray:
        return curve.cdf(axis.uncounted(counted)) / total

    none = np.zeros_like(cdf)
    lookup = Lookup.of(edges)
    return Marginal(axis.label, edges, shown, cdf, before / total, at_edge / total, none, axis.ends, lookup, at)


def _plane(chart: Chart, leaves: Leaves, marginals: tuple[Marginal, ...], samples: int) -> GridPlane:
    size = 1 << int(np.clip(0.5 * np.log2(max(samples, 1) / 2), np.log2(COARSE), np.log2(FINEST_PLANE)))
    rows, shares, edges = [], [], []
    for axis, marginal in zip(chart.axes, marginals, strict=True):
        cells = len(marginal.mass)
        rows.append(np.minimum((np.arange(cells) * size) // max(cells, 1), size - 1))
        shares.append(np.bincount(rows[-1], marginal.mass, size))
        first = np.searchsorted(rows[-1] * COARSE // size, np.arange(1, COARSE))
        ends = [axis.low], axis.uncounted(marginal.edges[first]), [axis.high]
        edges.append(np.concatenate(ends))
    mass, error = _masses(leaves, edges[0], edges[1])
    total = mass.sum() if mass.sum() > 0 else 1.0
    mass, error = mass / total, error / total
    product = mass.sum(axis=1)[:, None] * mass.sum(axis=0)
    independent = bool(np.all(np.abs(mass - product) <= _INDEPENDENT * product + error))
    independent = independent and bool(np.all(error <= 1e-3 * product + 1e-9))
    none = np.zeros(size + 1)
    return GridPlane((rows[0], rows[1]), (shares[0], shares[1]), none, none[1:], mass, error, independent)


def _masses(leaves: Leaves, first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the integrals over all cells of a grid with these edges, and bounds on their errors."""
    with np.errstate(invalid="ignore"):
        parts = [_parts(leaves.low[:, axis], leaves.high[:, axis], e) for axis, e in enumerate((first, second))]
        mass = np.sum(parts[0] @ coefficients_of(leaves) @ parts[1].transpose(0, 2, 1), axis=0)
    overlap = [_overlap(leaves.low[:, axis], leaves.high[:, axis], e) for axis, e in enumerate((first, second))]
    error = np.einsum("mi,mj,m->ij", *overlap, np.where(np.isfinite(leaves.error), partial_error(leaves), 1.0))
    return mass, error


def _parts(low: np.ndarray, high: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return (m, cells, 15) integrals of the Legendre polynomials of each box over its part in each cell."""
    s = np.clip((2 * edges - (low + high)[:, None]) / (high - low)[:, None], -1, 1)
    p = legendre(s.ravel(), len(NODES))
    k = np.arange(1, len(NODES))[:, None]
    integral = np.concatenate([p[1:2] + 1, (p[2:] - p[:-2]) / (2 * k + 1)]).T.reshape(*s.shape, len(NODES))
    return np.diff(integral, axis=1) * (0.5 * (high - low))[:, None, None]


def _overlap(low: np.ndarray, high: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return (m, cells) whether a box and a cell overlap, as 0 or 1."""
    return ((low[:, None] < edges[1:]) & (high[:, None] > edges[:-1])).astype(float)
