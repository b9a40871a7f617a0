"""What rounding can move across the edges of cells, charged where it arises.

A point is known to a few units in the last place of its coordinates. What happens inside a sampler shows where the same uniforms
are given in double precision: they lead elsewhere by just as much as single precision is off. Where they lead to the same point,
nothing shows; then a coordinate made of coarse numbers may be off by a few of their steps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fogproof.checks.density.grid import Grid, Marginal
from fogproof.domains import Law

ROUNDED = 8192
"""Points that show the effect of rounding."""

_HALF_TURN = 0.49  # of all probability: rounding moves a point at a pole to its other side
_REGIONS = 64  # of an axis in which it is averaged
_ROWS = 256  # the same, of the first axis, for what it does to the second
_INSIDE = 4.0  # times the mean shift that is seen: all values of one step of coarse numbers
_COARSE = 4.0  # units in the last place of the largest coordinate: what cancellation costs a textbook formula
_WINDOW = 256  # neighbours that tell how close values are
_DENSE = 1 / 4  # of a unit: values so close fill the steps of coarse numbers many times
_ENOUGH = 0.1  # of the values, that are so close
_HALF = 0.5
_STEPS = 0.7  # of the way that values cover, in gaps of half a unit or more
_TURNED = 1 - 2.0**-10  # of all probability: a point went once round, an angle under a map has ends
_POLE = 0.02  # of the points, the nearest to a pole


@dataclass(frozen=True)
class Rounded:
    """Points (q, ...), copies of them moved as rounding may move them, and the same samples in double precision, if they differ.

    grain  probability between neighbouring values of uniforms of few bits
    """

    points: np.ndarray
    nudges: list[np.ndarray]
    exact: np.ndarray | None
    roundoff: float
    grain: float = 0.0

    @property
    def moved(self) -> list[np.ndarray]:
        """All that the points may be instead."""
        return self.nudges if self.exact is None else [*self.nudges, self.exact]


def coarsely_moved(law: Law, rounded: Rounded) -> Rounded:
    """Return the same with points that are moved along coordinates made of coarse numbers as well.

    A map may see points finer than they were made: that of a cosine close to 1, rounded before it became a vector.
    """
    points = rounded.points
    if rounded.exact is not None or len(points) == 0:
        return rounded
    unit, moves = 0.5 * rounded.roundoff, []
    t = law.coordinates(points, np.full((len(points), len(law.axes)), 0.5))
    for axis in range(t.shape[1]):
        if _coarse(t[:, axis], unit):
            for step in (2 * _COARSE * unit, -2 * _COARSE * unit):
                moved = t[:ROUNDED].copy()
                moved[:, axis] = np.clip(moved[:, axis] + step, 0.0, 1.0)
                moves.append(law.place(moved))
    return replace(rounded, nudges=[*rounded.nudges, *moves])


def blurred(grid: Grid, count: Callable[[np.ndarray], tuple[np.ndarray, ...]], rounded: Rounded) -> Grid:
    """Return the grid with the probability that rounding moves a sample across each edge.

    count  points (q, ...) -> the coordinates (q,) in which they are counted
    """
    if len(rounded.points) == 0:
        return grid
    everywhere = count(rounded.points)
    counted = [c[:ROUNDED] for c in everywhere]
    moved = [count(points[:ROUNDED]) for points in rounded.moved]
    axes = []
    for axis, marginal in enumerate(grid.marginals):
        step = _step(marginal, everywhere[axis], rounded)
        others = [counted[axis] - step, counted[axis] + step, *(m[axis] for m in moved)]
        axes.append(_Axis(marginal, counted[axis], others, step, rounded.exact is not None, rounded.grain))
    blurs = [axis.blur(None if axis.marginal.ends else axes[1 - k]) for k, axis in enumerate(axes)]
    marginals = tuple(replace(m, blur=m.blur + blur) for m, blur in zip(grid.marginals, blurs, strict=True))
    plane = grid.plane
    if plane is not None:
        rows = plane.rows[0]
        first = blurs[0][np.append(np.searchsorted(rows, np.arange(plane.size)), len(rows))]
        edges = axes[0].marginal.cdf[np.append(np.searchsorted(rows, np.arange(plane.size)), len(rows))]
        across = axes[1].blur_in_rows(axes[0], edges)
        plane = replace(plane, along=plane.along + first, across=plane.across + across)
    return Grid(marginals, plane)


@dataclass(frozen=True)
class _Axis:
    """One axis: where points are on it (q,), where they may be instead, the last in double precision if `exact`.

    step  how far a counted coordinate may be off by what happens inside the sampler
    """

    marginal: Marginal
    counted: np.ndarray
    others: list[np.ndarray]
    step: float
    exact: bool
    grain: float

    @cached_property
    def at(self) -> np.ndarray:
        """The probability below each point, (q,)."""
        return self._probability(self.counted)

    @cached_property
    def shift(self) -> np.ndarray:
        """How far rounding moves each point, (q,), in probability."""
        at = self.at
        shifts = [np.abs(self._probability(other) - at) for other in self.others]
        shifts = [
            np.minimum(shift, 1 - shift) if not self.marginal.ends else np.where(shift > _TURNED, 1 - shift, shift)
            for shift in shifts
        ]
        if self.exact:
            shifts[-1] = _INSIDE * shifts[-1]
        return np.asarray(np.max(shifts, axis=0)) + self.grain

    @cached_property
    def turned(self) -> np.ndarray:
        """Which points, (q,), may come from anywhere on the axis: at a pole, under a map with ends, an angle says nothing."""
        away = np.abs([self._probability(other) - self.at for other in self.others])
        return np.asarray(np.any(np.minimum(away, 1 - away) > _HALF_TURN, axis=0))

    @cached_property
    def order(self) -> np.ndarray:
        """The points along the axis, (q,)."""
        return np.argsort(self.counted)

    def _probability(self, counted: np.ndarray) -> np.ndarray:
        """Return the probability below coordinates (q,); looked up along the axis, which is several times faster."""
        result = np.empty(len(counted))
        result[self.order] = np.interp(counted[self.order], self.marginal.edges, self.marginal.cdf)
        return result

    def near(self, side: int) -> float:
        """Return how far from a pole points are that rounding may move onto it, in the counted coordinate."""
        if not self.exact:
            return self.step
        nearest = np.argsort(side * self.counted)[: max(int(_POLE * len(self.counted)), 1)]
        return _INSIDE * float(np.mean(np.abs(self.counted - self.others[-1])[nearest]))

    def blur(self, pole: _Axis | None) -> np.ndarray:
        """Return (m + 1,) the probability that samples cross each edge; `pole` is the axis about whose ends this one turns."""
        mean = _mean_in_regions(self.at, self.shift, _REGIONS)
        blur = mean[np.minimum((self.marginal.cdf * _REGIONS).astype(np.intp), _REGIONS - 1)]
        lost = np.mean(self.turned) if pole is None else np.sum(pole.merged(np.array([0.0, 1.0])))
        blur = blur + float(lost)
        blur[[0, -1]] = 0.0
        return np.asarray(blur)

    def merged(self, shares: np.ndarray) -> np.ndarray:
        """Return (q,) the probability, between q + 1 shares of this axis, of points that rounding moves onto one of its ends.

        There an angle about that end says nothing.
        """
        m = self.marginal
        low, high = np.interp([m.edges[0] + self.near(1), m.edges[-1] - self.near(-1)], m.edges, m.cdf)
        return np.asarray(np.diff(np.minimum(shares, low)) + np.diff(np.maximum(shares, high)))

    def blur_in_rows(self, first: _Axis, edges: np.ndarray) -> np.ndarray:
        """Return (size,) the probability that samples of each row of the first axis leave or enter a cell along this one."""
        mean = _mean_in_regions(first.at, self.shift, _ROWS)
        middle = 0.5 * (edges[1:] + edges[:-1])
        across = 2 * np.diff(edges) * mean[np.minimum((middle * _ROWS).astype(np.intp), _ROWS - 1)]
        if not self.marginal.ends:
            return np.asarray(across + first.merged(edges))
        row = np.clip(np.searchsorted(edges, first.at, side="right") - 1, 0, len(middle) - 1)
        return np.asarray(across + 2 * np.bincount(row, self.turned, len(middle)) / len(row))


def _mean_in_regions(at: np.ndarray, shift: np.ndarray, regions: int) -> np.ndarray:
    """Return (regions,) the mean shift of points in regions of equal probability, or in a neighbour's if it is larger."""
    region = np.minimum((at * regions).astype(np.intp), regions - 1)
    total, count = np.bincount(region, shift, regions), np.bincount(region, minlength=regions)
    mean = np.divide(total, count, out=np.full(regions, float(np.mean(shift))), where=count > 0)
    return np.asarray(np.max([mean, np.append(mean[1:], 0), np.append(0, mean[:-1])], axis=0))


def _step(marginal: Marginal, counted: np.ndarray, rounded: Rounded) -> float:
    """Return how far a counted coordinate may be off by what happens inside the sampler and shows nowhere else."""
    unit = 0.5 * rounded.roundoff * float(marginal.edges[-1] - marginal.edges[0])
    if rounded.exact is not None:
        return 0.0
    return 2 * _COARSE * unit if not marginal.ends or _coarse(counted, unit) else 0.0


def _coarse(t: np.ndarray, unit: float) -> bool:
    """Return whether values (n,) lie on steps of about one unit, or too far apart to tell."""
    t = np.sort(t)
    gap = np.diff(t)
    ends = np.clip(np.arange(len(gap))[:, None] + (-_WINDOW // 2, _WINDOW // 2), 0, len(gap))
    dense = t[ends[:, 1]] - t[ends[:, 0]] < _DENSE * unit * (ends[:, 1] - ends[:, 0])
    if np.mean(dense) < _ENOUGH:
        return True
    gap = gap[dense]
    return float(gap[gap > _HALF * unit].sum()) > _STEPS * float(gap.sum())
