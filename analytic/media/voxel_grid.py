"""Voxels, nearest or trilinear."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.double_double import UNIT, Pair
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.geometry.rays import Thickness
from fogproof.analytic.media.breakpoints import Breaks, between
from fogproof.analytic.media.cells import SOURCE, CellSegments, GridAxis, segments, settled, thickness_of, values
from fogproof.analytic.media.coefficients import Coefficients, Points
from fogproof.analytic.media.squared_extinction import Integral, by_panels, of_squared
from fogproof.analytic.proven.balls import flint, rational, vector
from fogproof.analytic.proven.cells import constant_cells, stretches
from fogproof.analytic.proven.pieces import Piece
from fogproof.analytic.proven.trilinear import trilinear_piece
from fogproof.analytic.rays.compositing import composite
from fogproof.analytic.rays.radiance_by_quadrature import radiance_by_quadrature
from fogproof.contracts import Reference
from fogproof.scene import Ray, VoxelGrid

Corners = list[tuple[tuple[np.ndarray, ...], np.ndarray]]
"""What a value in a grid is made of: (index arrays of a cell, its weight at each point)."""

GAUSS = (0.5 - 0.5 / np.sqrt(3.0), 0.5 + 0.5 / np.sqrt(3.0))

LINEAR_IN = ("sigma_t",)
"""What sigma_t is proportional to wherever it stands alone: sums of these with weights >= 0, at the same albedo."""


def is_trilinear(medium: VoxelGrid) -> bool:
    """Return whether the grid interpolates between its voxels."""
    return medium.interpolation == "trilinear"


def coefficients(medium: VoxelGrid, at: Points) -> Coefficients:
    """Return the voxels' values or the means of eight; what albedo leaves is interpolated for itself, so it does not cancel."""
    corners = _corners(medium, at.x)
    sigma_t = _gather(medium.sigma_t, corners, at.shape)
    emission = _gather(medium.emission, corners, at.shape)
    scattered = np.minimum(_gather(medium.albedo, corners, at.shape), medium.albedo.max())
    absorbed = _gather(1.0 - medium.albedo, corners, at.shape)
    return Coefficients(sigma_t, absorbed * sigma_t, scattered * sigma_t, emission)


def _corners(grid: VoxelGrid, x: np.ndarray) -> Corners:
    """Return (index arrays, weights) of the voxels that make up the value at each point; no weight outside."""
    n = np.array(grid.sigma_t.shape[:3])
    c = (x - grid.lower) * (n / (grid.upper - grid.lower))
    inside = ((x >= grid.lower) & (x < grid.upper)).all(axis=-1)
    if grid.interpolation == "nearest":
        cell = np.clip(np.floor(c), 0, n - 1).astype(int)
        return [(tuple(np.moveaxis(cell, -1, 0)), inside.astype(float))]
    low = np.floor(np.clip(c, 0, n) - 0.5)
    u = np.clip(c - 0.5 - low, 0, 1)
    found: Corners = []
    for corner in product((0, 1), repeat=3):
        cell = np.clip(low + corner, 0, n - 1).astype(int)
        weight = np.prod(np.where(corner, u, 1 - u), axis=-1)
        found.append((tuple(np.moveaxis(cell, -1, 0)), inside * weight))
    return found


def _gather(array: np.ndarray, corners: Corners, shape: tuple[int, ...]) -> np.ndarray:
    """Return the weighted sum of an array's cells at the points, channels last; a constant counts inside only."""
    total = np.zeros(shape)
    for cells, weight in corners:
        found = array[cells] if array.ndim else np.broadcast_to(array, weight.shape)
        if weight.ndim < len(shape):
            weight = weight[..., None]
            found = found if found.ndim == len(shape) else found[..., None]
        total = total + found * weight
    return total


def breakpoints(medium: VoxelGrid, origin: np.ndarray, direction: np.ndarray, length: np.ndarray) -> Breaks:
    """Return where rays meet the planes between voxels, or through their centres if the grid is trilinear."""
    enter, leave = between(origin, direction, medium.lower, medium.upper, length)
    found = []
    for i, n in enumerate(medium.sigma_t.shape[:3]):
        inner = np.arange(n) + 0.5 if is_trilinear(medium) else np.arange(1.0, n)
        planes = medium.lower[i] + inner * ((medium.upper[i] - medium.lower[i]) / n)
        found.append((planes - origin[:, i, None]) / direction[:, i, None])
    return Breaks(enter, leave, found)


def crossed(medium: VoxelGrid, ray: Ray) -> Iterator[tuple[slice, CellSegments]]:
    """Yield what the flattened rays meet, in blocks; see `cells`."""
    return segments(ray, max(medium.sigma_t.shape[:3]), partial(_axes, medium))


def _axes(medium: VoxelGrid, origin: np.ndarray, direction: np.ndarray) -> list[GridAxis]:
    direction = dd.flushed(direction)
    axes = []
    for i, n in enumerate(medium.sigma_t.shape[:3]):
        size = dd.add(dd.pair(medium.upper[i]), dd.pair(-medium.lower[i]))
        alpha = dd.add(dd.pair(origin[:, i]), dd.pair(-medium.lower[i]))
        planes = np.concatenate([[0.0], np.arange(n) + 0.5, [n]]) if is_trilinear(medium) else np.arange(n + 1.0)
        per_metre = dd.divide(dd.pair(float(n)), size)
        axis = GridAxis(dd.times(alpha, per_metre), dd.times(dd.pair(direction[:, i]), per_metre), planes)
        axes.append(settled(axis, _coordinate(origin[:, i], medium.lower[i], medium.upper[i], n)))
    return axes


def _coordinate(places: np.ndarray, lower: float, upper: float, n: int) -> Callable[[int], Fraction]:
    """Return the coordinate in voxels of the ray with a given number, as an exact fraction."""
    return lambda ray: (Fraction(places[ray]) - Fraction(lower)) * n / (Fraction(upper) - Fraction(lower))


def thickness(medium: VoxelGrid, ray: Ray, channels: int | None) -> Thickness:
    """Return tau. Error: nearest 2^-100 relative, so that exp(-tau) sees an unrounded tau; trilinear 16 EPS."""
    mean, relative = (interpolate, 16 * EPS) if is_trilinear(medium) else (values, UNIT)
    found = thickness_of(medium.sigma_t, crossed(medium, ray), mean, relative)
    shape = ray.shape if medium.sigma_t.ndim == 3 else (*ray.shape, medium.sigma_t.shape[-1])
    value, low, error = (x.reshape(shape) for x in found)
    method = "sorted plane crossings" + (", Gauss-Legendre 2 in each cell" if is_trilinear(medium) else "")
    return Thickness(value, low, error, method, SOURCE)


def interpolate(array: np.ndarray, part: CellSegments) -> np.ndarray:
    """Return the mean along each segment of a trilinear array (nx, ny, nz), channels last: (n, channels or 1, segments).

    `part` has cells between the centres of voxels: cell j lies between the centres j - 1 and j, and the first and the
    last one are the half voxels at the border.
    """
    mean = np.zeros(())
    for node in GAUSS:
        t = dd.add(part.start, dd.times(part.length, dd.pair(node)))
        shares = [_shares(axis, cell, t) for axis, cell in zip(part.axes, part.cells, strict=True)]
        for corner in product((0, 1), repeat=3):
            ends = zip(part.cells, corner, array.shape[:3], strict=True)
            found = array[tuple(np.clip(cell - 1 + end, 0, n - 1) for cell, end, n in ends)]
            weight = np.prod([share[end] for share, end in zip(shares, corner, strict=True)], axis=0) / 2
            mean = (
                mean + (found * weight)[:, None]
                if found.ndim == 2
                else mean + np.moveaxis(found, -1, 1) * weight[:, None]
            )
    return mean


def _shares(axis: GridAxis, cell: np.ndarray, t: Pair) -> tuple[np.ndarray, np.ndarray]:
    """Return the weights of the lower and of the upper centre of the cells at t, in [0, 1].

    Each is taken from the pair: 1 - u of a rounded u would lose the digits of a small share, which may be the only one that counts.
    """
    alpha, beta = (dd.each(lambda x: x[:, None], pair) for pair in (axis.alpha, axis.beta))
    upper = dd.add(dd.add(alpha, dd.times(beta, t)), dd.pair(0.5 - cell))
    lower = dd.add(dd.pair(1.0), dd.negative(upper))
    return np.clip(lower[0], 0.0, 1.0), np.clip(upper[0], 0.0, 1.0)


def radiance(medium: VoxelGrid, ray: Ray, ambient: Any, background: Any, *, times_sigma_a: bool = True) -> Reference:
    """Return the radiance of sources that differ from voxel to voxel; arguments as for `radiance_by_quadrature`."""
    if is_trilinear(medium):
        return radiance_by_quadrature(medium, ray, ambient, background, times_sigma_a=times_sigma_a)
    return composite(medium, crossed(medium, ray), ray, ambient, background, times_sigma_a=times_sigma_a)


def emission_per_volume(medium: VoxelGrid, ray: Ray) -> Reference:
    """Return the radiance of voxels that glow of themselves."""
    return radiance(medium, ray, 0.0, 0.0, times_sigma_a=False)


def squared_extinction(medium: VoxelGrid, ray: Ray, channels: int | None) -> Integral:
    """Return the integral of sigma_t^2: constant in nearest voxels, of degree 6 between the centres of trilinear ones."""
    if is_trilinear(medium):
        return by_panels(medium, ray, channels)
    return of_squared(VoxelGrid(medium.sigma_t**2, medium.lower, medium.upper, "nearest"), ray, channels)


def pieces(medium: VoxelGrid, origin: np.ndarray, direction: np.ndarray, length: Any) -> list[Piece]:
    """Return the voxels in order, or the cells between their centres."""
    fq, shape = flint().fmpq, medium.sigma_t.shape[:3]
    lower, upper = ([*map(rational, x)] for x in (medium.lower, medium.upper))
    size = [(b - a) / n for a, b, n in zip(lower, upper, shape, strict=True)]
    o = [(rational(x) - a) / d for x, a, d in zip(origin, lower, size, strict=True)]
    w = [x / d for x, d in zip(vector(direction), size, strict=True)]
    half = fq(1, 2)
    inner = [[i + half for i in range(n)] if is_trilinear(medium) else [fq(i) for i in range(1, n)] for n in shape]
    planes = [[fq(0), *places, fq(n)] for places, n in zip(inner, shape, strict=True)]
    if not is_trilinear(medium):
        return constant_cells(medium, o, w, planes, length)
    return [
        trilinear_piece(medium, [x + part.start * d for x, d in zip(o, w, strict=True)], w, part.length)
        for part in stretches(o, w, planes, length)
    ]
