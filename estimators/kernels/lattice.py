"""Walking a straight line through the cells of a lattice (Amanatides & Woo 1987, "A Fast Voxel Traversal Algorithm").

Every crossing is computed from its plane, not by adding steps up, so that rounding does not grow along the way. A cell holds
its lower faces, not its upper ones; the lattice ends likewise.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.estimators.kernels.compiling import inlined
from fogproof.estimators.kernels.data import Lattice

PARALLEL = 1e-300
"""A direction's component below this never leads anywhere."""


class Line(NamedTuple):
    """Origin, direction and 1 / direction (0 where it is parallel to the planes)."""

    ox: float
    oy: float
    oz: float
    dx: float
    dy: float
    dz: float
    rx: float
    ry: float
    rz: float


class Cursor(NamedTuple):
    """A cell that the line enters at t and leaves at the least of tx, ty, tz and stop [m]; no more cells once t >= stop."""

    t: float
    stop: float
    ix: int
    iy: int
    iz: int
    tx: float
    ty: float
    tz: float


@inlined
def reciprocal(d: float) -> float:
    """Return 1 / d, 0 if the line is parallel to the planes."""
    return 1.0 / d if abs(d) > PARALLEL else 0.0


@inlined
def line_of(origin: np.ndarray, direction: np.ndarray, j: int) -> Line:
    """Return row j of origins and directions, both (rays, 3)."""
    dx, dy, dz = direction[j, 0], direction[j, 1], direction[j, 2]
    rx, ry, rz = reciprocal(dx), reciprocal(dy), reciprocal(dz)
    return Line(origin[j, 0], origin[j, 1], origin[j, 2], dx, dy, dz, rx, ry, rz)


@inlined
def clip(lower: float, upper: float, o: float, r: float, start: float, stop: float) -> tuple[float, float]:
    """Return the part of [start, stop] where o + t / r lies in [lower, upper); empty if start >= stop."""
    if r == 0.0:
        return (start, stop) if lower <= o < upper else (start, start)
    one, two = (lower - o) * r, (upper - o) * r
    return max(start, min(one, two)), min(stop, max(one, two))


@inlined
def plane(lower: float, size: float, n: int, shift: float, k: int) -> float:
    """Return the coordinate of plane k along one axis [m]."""
    return lower + size * min(max(k - shift, 0.0), float(n))


@inlined
def cells_along(n: int, shift: float) -> int:
    """Return how many cells there are along one axis."""
    return int(n + 2.0 * shift)


@inlined
def cell_of(lower: float, size: float, n: int, shift: float, x: float) -> int:
    """Return the index of the cell that holds x, the nearest one if none does."""
    last = cells_along(n, shift) - 1
    i = int(min(max((x - lower) / size + shift, 0.0), float(last)))
    if i > 0 and x < plane(lower, size, n, shift, i):
        return i - 1
    if i < last and x >= plane(lower, size, n, shift, i + 1):
        return i + 1
    return i


@inlined
def crossing(lower: float, size: float, n: int, shift: float, i: int, o: float, r: float) -> float:
    """Return where a line leaves cell i along one axis."""
    ahead = plane(lower, size, n, shift, i + 1 if r > 0.0 else i) - o
    return ahead * r if r != 0.0 else np.inf


@inlined
def enter(lattice: Lattice, line: Line, length: float) -> Cursor:
    """Return the cursor at the first cell within the length."""
    x0, y0, z0, hx, hy, hz, nx, ny, nz, shift = lattice
    start, stop = clip(x0, plane(x0, hx, nx, 0.0, nx), line.ox, line.rx, 0.0, length)
    start, stop = clip(y0, plane(y0, hy, ny, 0.0, ny), line.oy, line.ry, start, stop)
    start, stop = clip(z0, plane(z0, hz, nz, 0.0, nz), line.oz, line.rz, start, stop)
    if not start < stop:
        return Cursor(0.0, 0.0, 0, 0, 0, 0.0, 0.0, 0.0)
    ix = cell_of(x0, hx, nx, shift, line.ox + start * line.dx)
    iy = cell_of(y0, hy, ny, shift, line.oy + start * line.dy)
    iz = cell_of(z0, hz, nz, shift, line.oz + start * line.dz)
    tx = crossing(x0, hx, nx, shift, ix, line.ox, line.rx)
    ty = crossing(y0, hy, ny, shift, iy, line.oy, line.ry)
    tz = crossing(z0, hz, nz, shift, iz, line.oz, line.rz)
    return Cursor(start, stop, ix, iy, iz, tx, ty, tz)


@inlined
def leaves(cursor: Cursor) -> float:
    """Return where the line leaves the cell."""
    return max(cursor.t, min(min(cursor.tx, cursor.ty), min(cursor.tz, cursor.stop)))


@inlined
def advance(lattice: Lattice, line: Line, cursor: Cursor) -> Cursor:
    """Return the cursor at the next cell."""
    x0, y0, z0, hx, hy, hz, nx, ny, nz, shift = lattice
    t, stop, ix, iy, iz, tx, ty, tz = cursor
    if tx <= ty and tx <= tz:
        t, ix = max(t, tx), ix + (1 if line.rx > 0.0 else -1)
        tx = crossing(x0, hx, nx, shift, ix, line.ox, line.rx)
        outside = ix < 0 or ix >= cells_along(nx, shift)
    elif ty <= tz:
        t, iy = max(t, ty), iy + (1 if line.ry > 0.0 else -1)
        ty = crossing(y0, hy, ny, shift, iy, line.oy, line.ry)
        outside = iy < 0 or iy >= cells_along(ny, shift)
    else:
        t, iz = max(t, tz), iz + (1 if line.rz > 0.0 else -1)
        tz = crossing(z0, hz, nz, shift, iz, line.oz, line.rz)
        outside = iz < 0 or iz >= cells_along(nz, shift)
    return Cursor(t, t if outside else stop, ix, iy, iz, tx, ty, tz)
