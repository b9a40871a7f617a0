"""Layers and voxels: what lies between the planes that a ray crosses, all sorted at once.

A plane at coordinate p is met at t = (p - alpha)/beta, where alpha + beta t is the ray's coordinate along that axis,
in cells. All crossings of a ray are sorted at once; between two of them the cell is known from how many planes of
each axis have been passed, never from a rounded position. Crossings are pairs, so that a segment is as accurate far
from the camera as near it. Inside a cell the extinction is constant, or for trilinear interpolation a cubic in t,
which two-point Gauss-Legendre quadrature integrates exactly.

A ray that runs inside a plane between two cells sees the upper one; inside the upper face of the box, vacuum.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.double_double import UNIT, Pair
from fogproof.analytic.arithmetic.error_free import TINY
from fogproof.scene import Ray

SOURCE = "Amanatides & Woo 1987 (the cells met); Gauss 1814 (two nodes are exact for a cubic)"
BLOCK = 65536
"""Crossings sorted at a time."""


class GridAxis(NamedTuple):
    """n rays at coordinates alpha + beta t along one axis, each (n,), and the planes (P,) that bound its cells."""

    alpha: Pair
    beta: Pair
    planes: np.ndarray


class CellSegments(NamedTuple):
    """What n rays meet, (n, segments) each, in order along the ray; a segment outside the medium has length 0.

    start, length  [m], as pairs
    cells          index of the cell along each axis
    slack          (n,) how far all crossings of a ray together may be off [m]
    """

    axes: list[GridAxis]
    start: Pair
    length: Pair
    cells: list[np.ndarray]
    slack: np.ndarray


Pair3 = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Value, low part and error."""

Axes = Callable[[np.ndarray, np.ndarray], list[GridAxis]]
"""The axes of a medium's cells for rays with these origins and directions, (n, 3) each."""


def segments(ray: Ray, cells: int, axes: Axes) -> Iterator[tuple[slice, CellSegments]]:
    """Yield the segments of the flattened rays, in blocks: which rays, and what they meet.

    cells  along the longest axis
    """
    origin, direction, length = ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3), ray.length.reshape(-1)
    step = max(1, BLOCK // (1 + 3 * cells))
    for first in range(0, max(1, len(length)), step):
        rays = slice(first, first + step)
        yield rays, _sorted(axes(origin[rays], direction[rays]), length[rays])


def thickness_of(sigma_t: np.ndarray, parts: Iterator[tuple[slice, CellSegments]], mean: Any, relative: float) -> Pair3:
    """Return tau of rays (n, channels or 1) as a pair, and its error, from the mean extinction of each segment.

    mean      (array, segments) -> (n, channels or 1, segments)
    relative  error of the mean
    """
    found = []
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        for _, part in parts:
            sigma = mean(sigma_t, part)
            length = dd.where(sigma > 0, dd.each(lambda x: x[:, None], part.length), dd.pair(0.0))
            value, low = dd.total(dd.times(dd.pair(sigma), length))
            error = relative * value + part.slack[:, None] * sigma_t.max()
            error = error + (sigma.shape[-1] + 1) * TINY
            found.append((value, low, np.where(np.isinf(value), 0.0, error)))
    value, low, error = (np.concatenate(columns) for columns in zip(*found, strict=True))
    return value, low, error


def values(array: np.ndarray, part: CellSegments) -> np.ndarray:
    """Return the cells' values of an array of the medium, (n, channels or 1, segments); 0-d arrays hold everywhere."""
    if array.ndim == 0:
        return np.broadcast_to(array, (len(part.slack), 1, part.cells[0].shape[1]))
    found = array[tuple(part.cells)]
    return found[:, None] if found.ndim == 2 else np.moveaxis(found, -1, 1)


def settled(axis: GridAxis, exactly: Callable[[int], Fraction]) -> GridAxis:
    """Return the axis with alpha on the right side of a plane that a ray runs along, which pairs may be too short for.

    exactly  the coordinate of a ray in exact arithmetic, for the few that need it
    """
    value, low = (np.array(x) for x in axis.alpha)
    along = np.flatnonzero(axis.beta[0] == 0)
    planes = axis.planes[np.isfinite(axis.planes)]
    off = np.abs((value[along, None] - planes) + low[along, None])
    near = off <= UNIT * (np.abs(planes) + np.abs(value[along, None]))
    for row in np.flatnonzero(near.any(axis=-1)):
        ray, plane = int(along[row]), planes[near[row]][0]
        value[ray], low[ray] = plane, float(exactly(ray) - Fraction(plane))
    return axis._replace(alpha=(value, low))


def _sorted(axes: list[GridAxis], length: np.ndarray) -> CellSegments:
    """Sort the crossings of all axes and return what lies between them, cut to [0, length]."""
    crossings = [_crossings(axis) for axis in axes]
    value, low, uncertainty = (np.concatenate(columns, axis=-1) for columns in zip(*crossings, strict=True))
    leave = np.min([np.max(column, axis=-1) for column, _, _ in crossings], axis=0)
    leave = np.clip(leave, 0.0, length)[:, None]
    reached = (value >= -uncertainty) & (value <= leave + uncertainty)
    slack = np.sum(np.where(reached, np.minimum(uncertainty, leave), 0.0), axis=-1)

    order = np.lexsort((low, value), axis=-1)
    t = dd.each(lambda x: np.take_along_axis(x, order, axis=-1), (value, low))
    label = np.repeat(np.arange(len(axes)), [len(axis.planes) for axis in axes])
    owner = label[order][:, :-1]

    cells, outside = [], np.zeros(owner.shape, np.bool_)
    for i, axis in enumerate(axes):
        passed, last = np.cumsum(owner == i, axis=-1), len(axis.planes) - 1
        cell = np.where(axis.beta[0][:, None] < 0, last - passed, passed - 1)
        outside |= (cell < 0) | (cell >= last)
        cells.append(np.clip(cell, 0, last - 1))
    zero, far = dd.pair(np.zeros(t[0].shape)), dd.pair(np.broadcast_to(length[:, None], t[0].shape))
    t = dd.where(dd.less(t, zero), zero, t)
    t = dd.where(dd.less(far, t), far, t)
    start, end = dd.each(lambda x: x[:, :-1], t), dd.each(lambda x: x[:, 1:], t)
    nothing = outside | (start[0] == np.inf)
    start = dd.where(nothing, dd.pair(0.0), start)
    between = dd.where(nothing, dd.pair(0.0), dd.add(end, dd.negative(start)))
    return CellSegments(axes, start, between, cells, slack)


def _crossings(axis: GridAxis) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the pair of where the planes are met, (n, P), and its uncertainty; +-inf for rays that run along them."""
    alpha, beta = (dd.each(lambda x: x[:, None], pair) for pair in (axis.alpha, axis.beta))
    along = beta[0] == 0
    safe = dd.where(along, dd.pair(1.0), beta)
    with np.errstate(over="ignore", invalid="ignore"):
        ahead = dd.add(dd.pair(axis.planes), dd.negative(alpha))
        t = dd.divide(ahead, safe)
        uncertainty = UNIT * (np.abs(ahead[0]) + np.abs(alpha[0])) / np.abs(safe[0])
    side = np.where(ahead[0] > 0, np.inf, -np.inf)
    t = dd.where(along, dd.pair(side), t)
    return *t, np.where(along | ~np.isfinite(t[0]), 0.0, uncertainty)
