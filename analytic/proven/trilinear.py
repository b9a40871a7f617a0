"""Trilinear voxels as exact pieces: between the centres of voxels every field is a cubic polynomial along the ray."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

from fogproof.analytic.proven.balls import flint, rational
from fogproof.analytic.proven.pieces import Piece, horner
from fogproof.scene import VoxelGrid


def trilinear_piece(grid: VoxelGrid, start: list[Any], w: list[Any], length: Any) -> Piece:
    """Return the piece inside one cell between voxel centres, where every field is a cubic polynomial in z."""
    poly = flint().fmpq_poly
    sigma, albedo, emission = (
        _cubic(a, start, w, length) if a.ndim else poly([rational(a)])
        for a in (grid.sigma_t, grid.albedo, grid.emission)
    )
    integral = sigma.integral()
    tau = horner(integral)
    survived = lambda z: (-tau(z)).exp()  # noqa: E731
    return Piece(length, flint().arb(integral(length)), albedo, emission, survived=survived, extinction=sigma)


def _cubic(array: np.ndarray, start: list[Any], w: list[Any], length: Any) -> Any:
    """Return the polynomial through the exact interpolated values at four points of the piece (Newton's form)."""
    poly, fq = flint().fmpq_poly, flint().fmpq
    nodes = [length * fq(i, 3) for i in range(4)]
    table = [_interpolated(array, [x + z * d for x, d in zip(start, w, strict=True)]) for z in nodes]
    for level in range(1, 4):
        for i in range(3, level - 1, -1):
            table[i] = (table[i] - table[i - 1]) / (nodes[i] - nodes[i - level])
    result = poly([table[3]])
    for i in (2, 1, 0):
        result = result * poly([-nodes[i], 1]) + poly([table[i]])
    return result


def _interpolated(array: np.ndarray, place: list[Any]) -> Any:
    fq, axes = flint().fmpq, []
    for n, p in zip(array.shape, place, strict=True):
        above = min(max(p - fq(1, 2), fq(0)), fq(n - 1))
        low = min(int(above.floor()), max(n - 2, 0))
        axes.append([(low, 1 - (above - low)), (min(low + 1, n - 1), above - low)])
    return sum((a[1] * b[1] * c[1] * rational(array[a[0], b[0], c[0]]) for a, b, c in product(*axes)), fq(0))
