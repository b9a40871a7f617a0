"""The cells that samples are counted in: fine ones along each axis, coarse ones in the plane, and the probability of each.

The edges lie where the claimed density puts equal probabilities: they depend on nothing that the tested sample did. All
probabilities are those of the continuous part, given that a sample belongs to it: atoms are tested by themselves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

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
from fogproof.checks.density.lookup import Lookup
from fogproof.checks.density.quadrature import NODES, Leaves

_PER_CELL = 16  # samples expected in a fine cell
_MOST_CELLS = {1: 1 << 17, 2: 1 << 16}
_COARSE = 32  # cells along each axis of the plane
_FINEST_PLANE = 512
_INDEPENDENT = 1e-4  # axes are independent if no coarse cell differs by more than this share
_NO_BLUR = 1e-12  # of probability: what double precision does
_LAST_PLACES = 16  # units in the last place that a given map may be off
_REGIONS = 64  # cells of a pilot along each axis


@dataclass(frozen=True)
class Marginal:
    """One axis.

    label   what it is called
    edges   (m + 1,) of the cells, in the counted coordinate
    shown   (m + 1,) the edges as people are shown them
    cdf     (m + 1,) probability below each edge, from 0 to 1
    before  (m + 1,) bound on the error of the cdf from all that lies before the edge
    at_edge (m + 1,) bound on its error from the neighbourhood of the edge
    blur    (m + 1,) probability that the rounding of points moves a sample across the edge
    ends    whether the ends of the axis are ends of the domain
    lookup  finds the cell of a coordinate
    at      the cdf at any counted coordinates (q,)
    whole   whether the edges separate all points there are, as on `Discrete`
    """

    label: str
    edges: np.ndarray
    shown: np.ndarray
    cdf: np.ndarray
    before: np.ndarray
    at_edge: np.ndarray
    blur: np.ndarray
    ends: bool
    lookup: Lookup
    at: Callable[[np.ndarray], np.ndarray]
    whole: bool = False

    @property
    def mass(self) -> np.ndarray:
        """The probability of each cell, (m,)."""
        return np.diff(self.cdf)

    @property
    def error(self) -> np.ndarray:
        """Bound on the error of the cdf at each edge, (m + 1,)."""
        return self.before + self.at_edge

    def doubt(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Return (q,) bounds on the error of the probability between edges number `first` and `last`, (q,) each."""
        with np.errstate(invalid="ignore"):
            inner = self.before[last] - self.before[first]
        return np.where(np.isnan(inner), np.inf, inner) + self.at_edge[first] + self.at_edge[last]

    @property
    def scores(self) -> np.ndarray:
        """The middle of each cell's probabilities, (m,): uniform on (0, 1) for a right sampler, but for the cells' width."""
        return 0.5 * (self.cdf[:-1] + self.cdf[1:])


@dataclass(frozen=True)
class GridPlane:
    """The cells of two axes together.

    rows         two (m,) arrays: the row or column of the counted plane that each fine cell of an axis belongs to
    shares       two (size,) arrays: the probability of each counted row and column
    along        (size + 1,) probability that rounding moves a sample across each edge of the counted rows
    across       (size,) probability that it moves a sample of each row into or out of one of its cells
    mass         (32, 32) probability of the coarse cells
    error        (32, 32) bound on its error
    independent  whether the axes are independent: finer cells then have known probabilities too
    """

    rows: tuple[np.ndarray, np.ndarray]
    shares: tuple[np.ndarray, np.ndarray]
    along: np.ndarray
    across: np.ndarray
    mass: np.ndarray
    error: np.ndarray
    independent: bool

    @property
    def size(self) -> int:
        """Rows, and columns, that are counted."""
        return len(self.shares[0])

    def coarse(self, cells: list[np.ndarray]) -> np.ndarray:
        """Return (n,) the coarse cell, row by row, of points in the given fine cells (n,) of the two axes."""
        side, size = len(self.mass), self.size
        first, second = (rows[cell] * side // size for rows, cell in zip(self.rows, cells, strict=True))
        return np.asarray(first * side + second)

    def blur(self, size: int) -> np.ndarray:
        """Return (size, size) the probability that rounding moves into or out of each of as many cells."""
        if max(float(self.along.max()), float(self.across.max())) < _NO_BLUR:
            return np.zeros((size, size))
        step = self.size // size
        share = self.shares[1].reshape(size, step).sum(axis=1)
        rows = self.along[::step][:-1] + self.along[::step][1:]
        return np.asarray(rows[:, None] * share + self.across.reshape(size, step).sum(axis=1)[:, None])


@dataclass(frozen=True)
class Grid:
    """All cells of a domain."""

    marginals: tuple[Marginal, ...]
    plane: GridPlane | None


def cells_wanted(samples: int, axes: int) -> int:
    """Return how many fine cells an axis gets: a power of two."""
    return 1 << int(np.clip(np.log2(max(samples, 1) / _PER_CELL), 4, np.log2(_MOST_CELLS[axes])))


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


def line_grid_from_cdf(grid: Grid, cdf_at: Callable[[np.ndarray], np.ndarray], slack: float) -> Grid:
    """Return the cells of a line with the probabilities that a given cdf of the continuous part says, (m,) -> (m,)."""
    (marginal,) = grid.marginals
    values = cdf_at(marginal.edges)
    first, total = values[0], values[-1] - values[0]
    total = total if total > 0 else 1.0

    def at(counted: np.ndarray) -> np.ndarray:
        return (cdf_at(counted) - first) / total

    error = np.full_like(values, slack)
    none = np.zeros_like(values)
    return Grid((replace(marginal, cdf=(values - first) / total, before=none, at_edge=error, at=at),), None)


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
    size = 1 << int(np.clip(0.5 * np.log2(max(samples, 1) / 2), np.log2(_COARSE), np.log2(_FINEST_PLANE)))
    rows, shares, edges = [], [], []
    for axis, marginal in zip(chart.axes, marginals, strict=True):
        cells = len(marginal.mass)
        rows.append(np.minimum((np.arange(cells) * size) // max(cells, 1), size - 1))
        shares.append(np.bincount(rows[-1], marginal.mass, size))
        first = np.searchsorted(rows[-1] * _COARSE // size, np.arange(1, _COARSE))
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


def pilot_grid(labels: tuple[str, ...], u: np.ndarray) -> Grid:
    """Return cells that hold equal shares of pilot points u (n, k) along each axis: places in order, not known probabilities."""
    marginals = []
    for axis, label in enumerate(labels):
        inner = np.unique(u[:, axis])[:: max(len(u) // _REGIONS, 1)]
        edges = np.unique(np.concatenate([[0.0], inner[(inner > 0) & (inner < 1)], [1.0]]))
        share = np.interp(edges, np.sort(u[:, axis]), np.arange(len(u)) / len(u)) if len(u) else edges
        share[0], share[-1] = 0.0, 1.0
        unknown, none = np.full(len(edges), np.inf), np.zeros(len(edges))
        lookup = Lookup.of(edges)
        marginals.append(Marginal(label, edges, edges, share, unknown, none, none, False, lookup, lambda c: c))
    return Grid(tuple(marginals), None)


def unit_cube_grid(labels: tuple[str, ...], samples: int, roundoff: float) -> Grid:
    """Return the cells of the unit cube, where a right sampler's points are uniform under a given map."""
    cells = cells_wanted(samples, min(len(labels), 2))
    edges, slack = np.arange(cells + 1) / cells, max(_LAST_PLACES * roundoff, 1e-14)
    error, none, lookup = np.full(cells + 1, slack), np.zeros(cells + 1), Lookup.of(edges)
    marginals = tuple(
        Marginal(label, edges, edges, edges, none, error, none, True, lookup, lambda c: c) for label in labels
    )
    if len(labels) != 2:
        return Grid(marginals, None)
    size = 1 << int(np.clip(0.5 * np.log2(max(samples, 1) / 2), np.log2(_COARSE), np.log2(_FINEST_PLANE)))
    rows = (np.arange(cells) * size) // cells
    mass = np.full((_COARSE, _COARSE), _COARSE**-2.0)
    share, zero = np.full(size, 1 / size), np.zeros(size + 1)
    error = np.full_like(mass, slack)
    return Grid(marginals, GridPlane((rows, rows), (share, share), zero, zero[1:], mass, error, True))


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
