"""Optical thickness through layers and voxels by sorting the planes that a ray crosses.

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
from itertools import product
from typing import NamedTuple

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.double_double import UNIT, Pair
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.geometry.rays import Thickness
from fogproof.scene import PiecewiseConstantMedium, Ray, VoxelGrid

CellMedium = PiecewiseConstantMedium | VoxelGrid
SOURCE = "Amanatides & Woo 1987 (the cells met); Gauss 1814 (two nodes are exact for a cubic)"
GAUSS = (0.5 - 0.5 / np.sqrt(3.0), 0.5 + 0.5 / np.sqrt(3.0))
BLOCK = 65536
"""Crossings sorted at a time."""


class Axis(NamedTuple):
    """n rays at coordinates alpha + beta t along one axis, each (n,), and the planes (P,) that bound its cells."""

    alpha: Pair
    beta: Pair
    planes: np.ndarray


class Segments(NamedTuple):
    """What n rays meet, (n, segments) each, in order along the ray; a segment outside the medium has length 0.

    start, length  [m], as pairs
    cells          index of the cell along each axis
    slack          (n,) how far all crossings of a ray together may be off [m]
    """

    axes: list[Axis]
    start: Pair
    length: Pair
    cells: list[np.ndarray]
    slack: np.ndarray


def cell_thickness(medium: CellMedium, ray: Ray) -> Thickness:
    """Return tau of layers or voxels, shape R, or R + (channels,) if sigma_t has channels.

    Error: for constant cells 2^-100 relative, so that exp(-tau) sees an unrounded tau; for trilinear ones 16 EPS.
    """
    trilinear, parts = is_trilinear(medium), []
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        for _, part in segments(medium, ray):
            sigma = interpolate(medium.sigma_t, part) if trilinear else values(medium.sigma_t, part)
            length = dd.where(sigma > 0, dd.each(lambda x: x[:, None], part.length), dd.pair(0.0))
            value, low = dd.total(dd.times(dd.pair(sigma), length))
            error = (16 * EPS if trilinear else UNIT) * value + part.slack[:, None] * medium.sigma_t.max()
            error = error + (sigma.shape[-1] + 1) * TINY
            parts.append((value, low, np.where(np.isinf(value), 0.0, error)))
    shape = ray.shape if medium.sigma_t.ndim == dimensions(medium) else (*ray.shape, medium.sigma_t.shape[-1])
    value, low, error = (np.concatenate(columns).reshape(shape) for columns in zip(*parts, strict=True))
    method = "sorted plane crossings" + (", Gauss-Legendre 2 in each cell" if trilinear else "")
    return Thickness(value, low, error, method, SOURCE)


def is_trilinear(medium: CellMedium) -> bool:
    """Return whether the medium interpolates between its cells."""
    return isinstance(medium, VoxelGrid) and medium.interpolation == "trilinear"


def dimensions(medium: CellMedium) -> int:
    """Return the number of axes of the cells, without channels."""
    return 3 if isinstance(medium, VoxelGrid) else 1


def values(array: np.ndarray, part: Segments) -> np.ndarray:
    """Return the cells' values of an array of the medium, (n, channels or 1, segments); 0-d arrays hold everywhere."""
    if array.ndim == 0:
        return np.broadcast_to(array, (len(part.slack), 1, part.cells[0].shape[1]))
    found = array[tuple(part.cells)]
    return found[:, None] if found.ndim == 2 else np.moveaxis(found, -1, 1)


def interpolate(array: np.ndarray, part: Segments) -> np.ndarray:
    """Return the mean along each segment of a trilinear array (nx, ny, nz), channels last: (n, channels or 1, segments).

    `part` has cells between the centres of voxels: cell j lies between the centres j - 1 and j, and the first and the
    last one are the half voxels at the border.
    """
    mean = np.zeros(())
    for node in GAUSS:
        t = dd.add(part.start, dd.times(part.length, dd.pair(node)))
        u = [_above_centre(axis, cell, t) for axis, cell in zip(part.axes, part.cells, strict=True)]
        for corner in product((0, 1), repeat=3):
            ends = zip(part.cells, corner, array.shape[:3], strict=True)
            found = array[tuple(np.clip(cell - 1 + end, 0, n - 1) for cell, end, n in ends)]
            weight = np.prod([x if end else 1 - x for x, end in zip(u, corner, strict=True)], axis=0) / 2
            mean = (
                mean + (found * weight)[:, None]
                if found.ndim == 2
                else mean + np.moveaxis(found, -1, 1) * weight[:, None]
            )
    return mean


def _above_centre(axis: Axis, cell: np.ndarray, t: Pair) -> np.ndarray:
    """Return how far the points at t are above the lower centre of their cell, in [0, 1]."""
    alpha, beta = (dd.each(lambda x: x[:, None], pair) for pair in (axis.alpha, axis.beta))
    place = dd.add(dd.add(alpha, dd.times(beta, t)), dd.pair(0.5 - cell))
    return np.clip(place[0], 0.0, 1.0)


def segments(medium: CellMedium, ray: Ray) -> Iterator[tuple[slice, Segments]]:
    """Yield the segments of the flattened rays, in blocks: which rays, and what they meet."""
    origin, direction, length = ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3), ray.length.reshape(-1)
    count = 1 + max(medium.sigma_t.shape[:3]) * 3
    step = max(1, BLOCK // count)
    for first in range(0, max(1, len(length)), step):
        rays = slice(first, first + step)
        axes = _axes(medium, origin[rays], direction[rays])
        yield rays, _sorted(axes, length[rays])


def _axes(medium: CellMedium, origin: np.ndarray, direction: np.ndarray) -> list[Axis]:
    if isinstance(medium, PiecewiseConstantMedium):
        normal = [Fraction(x) for x in dd.flushed(medium.axis)]
        layers = Axis(dd.dot(medium.axis, origin), dd.dot(medium.axis, direction), medium.boundaries)

        def height(ray: int) -> Fraction:
            return sum((a * Fraction(x) for a, x in zip(normal, origin[ray], strict=True)), Fraction(0))

        return [_settled(layers, height)]
    direction = dd.flushed(direction)
    axes = []
    for i, n in enumerate(medium.sigma_t.shape[:3]):
        size = dd.add(dd.pair(medium.upper[i]), dd.pair(-medium.lower[i]))
        alpha = dd.add(dd.pair(origin[:, i]), dd.pair(-medium.lower[i]))
        planes = np.concatenate([[0.0], np.arange(n) + 0.5, [n]]) if is_trilinear(medium) else np.arange(n + 1.0)
        per_metre = dd.divide(dd.pair(float(n)), size)
        axis = Axis(dd.times(alpha, per_metre), dd.times(dd.pair(direction[:, i]), per_metre), planes)
        axes.append(_settled(axis, _coordinate(origin[:, i], medium.lower[i], medium.upper[i], n)))
    return axes


def _coordinate(places: np.ndarray, lower: float, upper: float, n: int) -> Callable[[int], Fraction]:
    """Return the coordinate in voxels of the ray with a given number, as an exact fraction."""
    return lambda ray: (Fraction(places[ray]) - Fraction(lower)) * n / (Fraction(upper) - Fraction(lower))


def _settled(axis: Axis, exactly: Callable[[int], Fraction]) -> Axis:
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


def _sorted(axes: list[Axis], length: np.ndarray) -> Segments:
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
    return Segments(axes, start, between, cells, slack)


def _crossings(axis: Axis) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
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
