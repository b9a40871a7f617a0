"""Straight lines through the region of a medium, and against a surface, one line at a time."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernels.compiling import inlined
from fogproof.estimators.kernels.path_data import BALL, BOX, LAYER, PLANE, SPHERE, Region, Wall


@inlined
def between(low: float, high: float, height: float, rise: float) -> tuple[float, float]:
    """Return where height + t rise lies in [low, high]; empty if the first is not below the second."""
    if rise == 0.0:
        return (-np.inf, np.inf) if low <= height <= high else (np.inf, -np.inf)
    one, two = (low - height) / rise, (high - height) / rise
    return min(one, two), max(one, two)


@inlined
def roots(x: float, y: float, z: float, dx: float, dy: float, dz: float, radius: float) -> tuple[float, float]:
    """Return where x + t d meets a sphere about the origin, without cancellation; empty if it does not."""
    b = x * dx + y * dy + z * dz
    px, py, pz = x - b * dx, y - b * dy, z - b * dz
    square = radius * radius - (px * px + py * py + pz * pz)
    if not square > 0.0:
        return np.inf, -np.inf
    half = np.sqrt(square)
    far = -b - np.copysign(half, b)  # no branch: half of all directions would go either way, unforeseen
    near = (x * x + y * y + z * z - radius * radius) / far
    return min(near, far), max(near, far)


@inlined
def crossing(region: Region, x: float, y: float, z: float, dx: float, dy: float, dz: float) -> tuple[float, float]:
    """Return where a line enters and leaves the region, +-inf if never; empty if it misses."""
    r = region
    if r.kind == LAYER:
        return between(r.bx, r.by, r.ax * x + r.ay * y + r.az * z, r.ax * dx + r.ay * dy + r.az * dz)
    if r.kind == BALL:
        return roots(x - r.ax, y - r.ay, z - r.az, dx, dy, dz, r.bx)
    if r.kind == BOX:
        x0, x1 = between(r.ax, r.bx, x, dx)
        y0, y1 = between(r.ay, r.by, y, dy)
        z0, z1 = between(r.az, r.bz, z, dz)
        return max(max(x0, y0), z0), min(min(x1, y1), z1)
    return -np.inf, np.inf


@inlined
def outward(region: Region, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return the normal out of the region at a point of its boundary."""
    r = region
    if r.kind == LAYER:
        height = r.ax * x + r.ay * y + r.az * z
        sign = 1.0 if r.by - height < height - r.bx else -1.0
        return sign * r.ax, sign * r.ay, sign * r.az
    if r.kind == BALL:
        return (x - r.ax) / r.bx, (y - r.ay) / r.bx, (z - r.az) / r.bx
    nearest, nx, ny, nz = abs(x - r.ax), -1.0, 0.0, 0.0
    if abs(r.bx - x) < nearest:
        nearest, nx, ny, nz = abs(r.bx - x), 1.0, 0.0, 0.0
    if abs(y - r.ay) < nearest:
        nearest, nx, ny, nz = abs(y - r.ay), 0.0, -1.0, 0.0
    if abs(r.by - y) < nearest:
        nearest, nx, ny, nz = abs(r.by - y), 0.0, 1.0, 0.0
    if abs(z - r.az) < nearest:
        nearest, nx, ny, nz = abs(z - r.az), 0.0, 0.0, -1.0
    if abs(r.bz - z) < nearest:
        nx, ny, nz = 0.0, 0.0, 1.0
    return nx, ny, nz


@inlined
def reach(wall: Wall, x: float, y: float, z: float, dx: float, dy: float, dz: float, on_it: bool) -> float:
    """Return the distance of the wall along a line, inf if it is not met.

    on_it  the line starts on the wall: a plane is not met again, a sphere only from within, at the far side
    """
    if wall.kind == PLANE:
        height = wall.size - (wall.ax * x + wall.ay * y + wall.az * z)
        rise = wall.ax * dx + wall.ay * dy + wall.az * dz
        t = height / rise if rise != 0.0 and not on_it else np.inf
        return t if t > 0.0 else np.inf
    if wall.kind == SPHERE:
        x, y, z = x - wall.ax, y - wall.ay, z - wall.az
        near, far = roots(x, y, z, dx, dy, dz, wall.size)
        if on_it:
            return far if x * dx + y * dy + z * dz < 0.0 else np.inf
        if near < far:
            return near if near > 0.0 else (far if far > 0.0 else np.inf)
    return np.inf


@inlined
def wall_normal(wall: Wall, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a unit normal of the wall at one of its points, on either side."""
    if wall.kind == PLANE:
        return wall.ax, wall.ay, wall.az
    return (x - wall.ax) / wall.size, (y - wall.ay) / wall.size, (z - wall.az) / wall.size
