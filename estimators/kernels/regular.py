"""Regular tracking: the optical thickness is summed up cell by cell until it reaches a given value or the end.

What each sum rounds off is carried to the next (Kahan 1965): the error does not grow with the number of cells.
"""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernels.compiling import inlined, kernel
from fogproof.estimators.kernels.data import Lattice
from fogproof.estimators.kernels.lattice import Cursor, Line, advance, enter, leaves, line_of


@kernel
def through_constant_cells(
    sigma: np.ndarray,
    channel: int,
    lattice: Lattice,
    origin: np.ndarray,
    direction: np.ndarray,
    length: np.ndarray,
    depth: np.ndarray,
    distance: np.ndarray,
    tau: np.ndarray,
    cells: np.ndarray,
) -> None:
    """Track through cells of constant extinction.

    sigma               (nx, ny, nz, channels) [1/m]
    origin, direction   (rays, 3); length (rays,): rays is 1, or as many as there are depths
    depth               (n,) optical depth at which to stop
    distance, tau, cells  (n,) results: where the depth is reached, or the length; the optical depth there; cells met
    """
    for i in range(len(depth)):
        j = i if len(length) > 1 else 0
        line = line_of(origin, direction, j)
        cursor = enter(lattice, line, length[j])
        end, total, lost, met, wanted = length[j], 0.0, 0.0, 0, depth[i]
        while cursor.t < cursor.stop:
            met += 1
            here = sigma[cursor.ix, cursor.iy, cursor.iz, channel]
            term = here * (leaves(cursor) - cursor.t) - lost
            after = total + term
            if after > wanted:
                end = min(cursor.t + (wanted - total) / here, leaves(cursor))
                total = wanted
                break
            lost, total = ((after - total) - term if after < np.inf else 0.0), after
            cursor = advance(lattice, line, cursor)
        distance[i], tau[i], cells[i] = end, total, met


@kernel
def through_trilinear_cells(
    sigma: np.ndarray,
    channel: int,
    lattice: Lattice,
    origin: np.ndarray,
    direction: np.ndarray,
    length: np.ndarray,
    depth: np.ndarray,
    distance: np.ndarray,
    tau: np.ndarray,
    cells: np.ndarray,
) -> None:
    """Track through cells between the centres of voxels, inside of which the extinction is a cubic along the line.

    Arguments as above; the lattice has one cell more along each axis than there are voxels.
    """
    for i in range(len(depth)):
        j = i if len(length) > 1 else 0
        line = line_of(origin, direction, j)
        cursor = enter(lattice, line, length[j])
        end, total, lost, met, wanted = length[j], 0.0, 0.0, 0, depth[i]
        while cursor.t < cursor.stop:
            met += 1
            width = leaves(cursor) - cursor.t
            a, b, c, d = cubic(sigma, channel, lattice, line, cursor, width)
            term = width * max(0.0, a + b / 2 + c / 3 + d / 4) - lost
            after = total + term
            if after > wanted:
                end = cursor.t + width * reached(a, b, c, d, (wanted - total) / width)
                total = wanted
                break
            lost, total = ((after - total) - term if after < np.inf else 0.0), after
            cursor = advance(lattice, line, cursor)
        distance[i], tau[i], cells[i] = end, total, met


@inlined
def cubic(
    sigma: np.ndarray, channel: int, lattice: Lattice, line: Line, cursor: Cursor, width: float
) -> tuple[float, float, float, float]:
    """Return the coefficients of sigma = a + b s + c s^2 + d s^3 along a segment, s from 0 at its start to 1 at its end."""
    nx, ny, nz, _ = sigma.shape
    x0, x1, u0, u1 = edge(lattice.lower_x, lattice.size_x, nx, cursor.ix, line.ox, line.dx, cursor.t, width)
    y0, y1, v0, v1 = edge(lattice.lower_y, lattice.size_y, ny, cursor.iy, line.oy, line.dy, cursor.t, width)
    z0, z1, w0, w1 = edge(lattice.lower_z, lattice.size_z, nz, cursor.iz, line.oz, line.dz, cursor.t, width)
    # along x each edge is p + q s; along y each face r + s' s + s'' s^2; along z the cubic
    f000, f100 = sigma[x0, y0, z0, channel], sigma[x1, y0, z0, channel]
    f010, f110 = sigma[x0, y1, z0, channel], sigma[x1, y1, z0, channel]
    f001, f101 = sigma[x0, y0, z1, channel], sigma[x1, y0, z1, channel]
    f011, f111 = sigma[x0, y1, z1, channel], sigma[x1, y1, z1, channel]
    a0, a1, a2 = face(f000, f100, f010, f110, u0, u1, v0, v1)
    b0, b1, b2 = face(f001, f101, f011, f111, u0, u1, v0, v1)
    d0, d1, d2 = b0 - a0, b1 - a1, b2 - a2
    return a0 + w0 * d0, a1 + w0 * d1 + w1 * d0, a2 + w0 * d2 + w1 * d1, w1 * d2


@inlined
def edge(
    lower: float, size: float, n: int, i: int, o: float, d: float, t: float, width: float
) -> tuple[int, int, float, float]:
    """Return the two voxels whose centres bound cell i, how far the segment starts above the first, and how far it climbs."""
    low, high = max(i - 1, 0), min(i, n - 1)
    if low == high:
        return low, high, 0.0, 0.0
    centre = lower + size * (i - 0.5)
    per_metre = 1.0 / size
    start = min(max((o + t * d - centre) * per_metre, 0.0), 1.0)
    return low, high, start, min(max((o + (t + width) * d - centre) * per_metre, 0.0), 1.0) - start


@inlined
def face(
    f00: float, f10: float, f01: float, f11: float, u0: float, u1: float, v0: float, v1: float
) -> tuple[float, float, float]:
    """Return the coefficients of bilinear interpolation along a line u0 + u1 s, v0 + v1 s."""
    p, q = f00 + u0 * (f10 - f00), u1 * (f10 - f00)
    r, s = f01 + u0 * (f11 - f01), u1 * (f11 - f01)
    return p + v0 * (r - p), q + v0 * (s - q) + v1 * (r - p), v1 * (s - q)


@inlined
def reached(a: float, b: float, c: float, d: float, wanted: float) -> float:
    """Return s in [0, 1] at which the integral of the cubic from 0 reaches `wanted`: Newton's method inside a bracket."""
    low, high = 0.0, 1.0
    s = 0.5
    for _ in range(100):
        rest = s * (a + s * (b / 2 + s * (c / 3 + s * (d / 4)))) - wanted
        if rest > 0.0:
            high = s
        else:
            low = s
        slope = a + s * (b + s * (c + s * d))
        step = s - rest / slope
        new = step if low < step < high else 0.5 * (low + high)
        if abs(new - s) <= 2e-16:
            return new
        s = new
    return s
