"""Optical thickness of grids whose rays run along faces and edges, through corners, and come from afar."""

from __future__ import annotations

from itertools import product

import numpy as np

from fogproof import analytic
from fogproof.estimators import regular_tracking
from fogproof.scene import Ray, VoxelGrid
from fogproof.stability.axes import decades, including, of
from fogproof.stability.exact import flint
from fogproof.stability.formula import Formula, HardRegion, Naive

N = 4


def voxel(i, j, k):
    """An eighth of a whole number, so that every sum of a few is exact."""
    return ((7 * i + 3 * j + 5 * k) % 11 + 1) / 8


VALUES = np.array([[[voxel(i, j, k) for k in range(N)] for j in range(N)] for i in range(N)])


def grid(interpolation):
    return VoxelGrid(VALUES, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), interpolation)


def rays(ox, oy, oz, dx, dy, dz):
    return Ray(np.stack([ox, oy, oz], axis=-1), np.stack([dx, dy, dz], axis=-1), np.full(len(ox), np.inf))


def tracked(interpolation):
    return lambda **x: regular_tracking(grid(interpolation), rays(**x)).tau


def thickness(interpolation):
    return lambda **x: analytic.optical_thickness(grid(interpolation), rays(**x))


def clipped(low, high, o, d):
    """The part of a line from its origin on with low <= o + t d < high, None if there is none."""
    zero = flint().arb(0)
    enter, leave = zero, flint().arb.pos_inf()
    for a, b, p, v in zip(low, high, o, d, strict=True):
        if v.is_zero():
            if not (a <= p < b):
                return None
            continue
        near, far = ((a - p) / v, (b - p) / v) if v > 0 else ((b - p) / v, (a - p) / v)
        enter, leave = enter.max(near), leave.min(far)
    return (enter, leave) if enter < leave else None


def true_nearest(ox, oy, oz, dx, dy, dz):
    fmpq, total = flint().fmpq, flint().arb(0)
    for index in product(range(N), repeat=3):
        part = clipped([fmpq(i, N) for i in index], [fmpq(i + 1, N) for i in index], (ox, oy, oz), (dx, dy, dz))
        if part is not None:
            total += voxel(*index) * (part[1] - part[0])
    return total


def trilinear(x):
    """The value between the eight nearest centres; the outermost half voxels repeat what is beside them."""
    total, axes = flint().arb(0), []
    for c in x:
        place = (c * N - flint().fmpq(1, 2)).max(flint().arb(0)).min(flint().arb(N - 1))
        low = min(int(float(place.mid())), N - 2)
        axes.append(((low, 1 - (place - low)), (low + 1, place - low)))
    for (i, a), (j, b), (k, c) in product(*axes):
        total += a * b * c * voxel(i, j, k)
    return total


def true_trilinear(ox, oy, oz, dx, dy, dz):
    """Simpson's rule in each cell between centres, exact for the cubic there."""
    o, d, fmpq = (ox, oy, oz), (dx, dy, dz), flint().fmpq
    planes = [fmpq(0), *(fmpq(2 * i + 1, 2 * N) for i in range(N)), fmpq(1)]
    total = flint().arb(0)
    for index in product(range(N + 1), repeat=3):
        part = clipped([planes[i] for i in index], [planes[i + 1] for i in index], o, d)
        if part is not None:
            a, b = part
            at = [trilinear([p + t * v for p, v in zip(o, d, strict=True)]) for t in (a, (a + b) / 2, b)]
            total += (b - a) * (at[0] + 4 * at[1] + at[2]) / 6
    return total


def nudged(ox, oy, oz, dx, dy, dz):
    """Cell after cell, each entered a ten-thousandth behind its face."""
    total, t = np.zeros_like(ox), np.zeros_like(ox)
    o, d = np.stack([ox, oy, oz]), np.stack([dx, dy, dz])
    with np.errstate(all="ignore"):
        near = np.where(d != 0, np.minimum((0 - o) / d, (1 - o) / d), -np.inf).max(axis=0)
        end = np.where(d != 0, np.maximum((0 - o) / d, (1 - o) / d), np.inf).min(axis=0)
        t = np.maximum(near, 0) + 1e-4
        for _ in range(3 * N + 3):
            cell = np.clip(np.floor((o + t * d) * N).astype(int), 0, N - 1)
            face = np.where(d > 0, (cell + 1) / N, cell / N)
            out = np.where(d != 0, (face - o) / d, np.inf).min(axis=0)
            leave = np.minimum(np.maximum(out, t), end)
            total += np.where(t < end, VALUES[tuple(cell)] * (leave - t + 1e-4), 0)
            t = leave + 1e-4
    return total


def along_x(y, z):
    one, zero = np.ones_like(y), np.zeros_like(y)
    return {"ox": -one, "oy": y, "oz": z, "dx": one, "dy": zero, "dz": zero}


def oblique(far, y):
    """A ray to (1/8, y, 3/8) from `far` away."""
    dx, dy, dz = (np.full_like(far, v) for v in (0.48, 0.6, 0.64))
    return {"ox": 0.125 - far * dx, "oy": y - far * dy, "oz": 0.375 - far * dz, "dx": dx, "dy": dy, "dz": dz}


def diagonal(y, z):
    """From a corner's neighbourhood through the neighbourhoods of the others."""
    third = np.full_like(y, 1 / np.sqrt(3))
    return {"ox": np.zeros_like(y), "oy": y, "oz": z, "dx": third, "dy": third, "dz": third}


def grown(faces):
    """Values on faces, and by one rounding beside them."""
    return of(*(face * scale for face in faces for scale in (1.0, 1 - 2**-53, 1 + 2**-52)), 0.1)


FACES = grown((0.0, 0.25))
LITTLE = including(decades(1e-16, 0.2), 0.0)
VOXELS = (
    HardRegion("along faces and edges", {"y": FACES, "z": FACES}, derived=along_x),
    HardRegion("through corners", {"y": LITTLE, "z": LITTLE}, derived=diagonal),
    HardRegion("from 1e8 away", {"far": decades(1e-3, 1e8), "y": decades(1e-3, 0.9)}, derived=oblique),
)
FORMULAS = [
    Formula(
        "geometry/voxels_nearest",
        "Optical thickness of a grid, walked cell by cell",
        "estimators.regular_tracking",
        tracked("nearest"),
        true_nearest,
        VOXELS,
        bound=3.0,
        naive=(Naive("a small step over each face", "renderers that find cells by floor", nudged),),
        size=0.5,
    ),
    Formula(
        "geometry/voxels_trilinear",
        "Optical thickness of a trilinear grid, walked cell by cell",
        "estimators.regular_tracking",
        tracked("trilinear"),
        true_trilinear,
        VOXELS,
        bound=3.0,
        size=0.34,
    ),
    Formula(
        "geometry/thickness_nearest",
        "The oracle's optical thickness of a grid",
        "analytic.optical_thickness",
        thickness("nearest"),
        true_nearest,
        VOXELS,
        size=0.5,
    ),
    Formula(
        "geometry/thickness_trilinear",
        "The oracle's optical thickness of a trilinear grid",
        "analytic.optical_thickness",
        thickness("trilinear"),
        true_trilinear,
        VOXELS,
        size=0.34,
    ),
]
