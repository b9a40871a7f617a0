"""What kernels work on: plain tuples of numbers and arrays. Their types choose, at compile time, what a kernel does with them."""

from __future__ import annotations

from typing import Any, NamedTuple

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


class LinearData(NamedTuple):
    """max(0, sigma_0 + gradient . x); sigma_0 (channels,) [1/m], gradient (channels, 3) [1/m^2]."""

    sigma_0: np.ndarray
    gradient: np.ndarray


class ExponentialData(NamedTuple):
    """sigma_0 exp(rate . x); sigma_0 (channels,) [1/m], rate (channels, 3) [1/m]."""

    sigma_0: np.ndarray
    rate: np.ndarray


class LayerData(NamedTuple):
    """Layers between boundaries (n + 1,) along axis (3,); sigma (n, channels) [1/m]."""

    sigma: np.ndarray
    boundaries: np.ndarray
    axis: np.ndarray


class NearestData(NamedTuple):
    """Voxels of constant extinction; sigma (nx, ny, nz, channels) [1/m], lower (3,) [m], voxels a metre (3,) [1/m]."""

    sigma: np.ndarray
    lower: np.ndarray
    per_metre: np.ndarray


class TrilinearData(NamedTuple):
    """The same, interpolated between the centres of voxels."""

    sigma: np.ndarray
    lower: np.ndarray
    per_metre: np.ndarray


class NoiseData(NamedTuple):
    """Fractal noise, see `fogproof.estimators.FractalNoise`."""

    density: float
    frequency: float
    octaves: int
    gain: float
    table: np.ndarray


class FieldData(NamedTuple):
    """A user's numba function of (x, y, z)."""

    function: Any


class ChromaticFieldData(NamedTuple):
    """A user's numba function of (x, y, z, channel)."""

    function: Any


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
