"""What kernels work on: plain tuples of numbers and arrays. Their types choose, at compile time, what a kernel does with them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Lattice(NamedTuple):
    """Equal voxels and the planes between cells. Plain numbers, because arrays would be reference-counted at each step.

    lower, size  corner of the lattice and edges of a voxel [m]
    n            voxels along each axis
    shift        0 if the cells are the voxels; 1/2 if they lie between the centres of voxels, one cell more along each axis

    Plane k is lower + size (k - shift), but inside the lattice.
    """

    lower_x: float
    lower_y: float
    lower_z: float
    size_x: float
    size_y: float
    size_z: float
    nx: int
    ny: int
    nz: int
    shift: float

    @staticmethod
    def between(lower: np.ndarray, upper: np.ndarray, n: tuple[int, ...], shift: float = 0.0) -> Lattice:
        """Return the lattice of n (3,) voxels in the box with corners lower and upper (3,)."""
        (x, y, z), (a, b, c) = lower.tolist(), ((upper - lower) / n).tolist()
        return Lattice(x, y, z, a, b, c, int(n[0]), int(n[1]), int(n[2]), shift)


class RayBound(NamedTuple):
    """One bound a ray: control and majorant (rays,) [1/m], inside a box with corners lower and upper (3,) [m]."""

    control: np.ndarray
    majorant: np.ndarray
    lower: np.ndarray
    upper: np.ndarray


class BlockBound(NamedTuple):
    """One bound a block: control and majorant (bx, by, bz) [1/m], in the cells of a lattice."""

    control: np.ndarray
    majorant: np.ndarray
    lattice: Lattice
