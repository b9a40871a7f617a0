"""Voxels for kernels: which one a point lies in, or the eight between whose centres it lies."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.estimators.kernels.compiling import inlined


@inlined
def _voxel(x: float, lower: float, per_metre: float, n: int) -> int:
    return min(max(int(np.floor((x - lower) * per_metre)), 0), n - 1)


@inlined
def _centres(x: float, lower: float, per_metre: float, n: int) -> tuple[int, int, float]:
    u = min(max((x - lower) * per_metre - 0.5, 0.0), n - 1.0)
    i = int(u)
    return i, min(i + 1, n - 1), u - i


class NearestData(NamedTuple):
    """Voxels of constant extinction; sigma (nx, ny, nz, channels) [1/m], lower (3,) [m], voxels a metre (3,) [1/m]."""

    sigma: np.ndarray
    lower: np.ndarray
    per_metre: np.ndarray

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        nx, ny, nz, _ = medium.sigma.shape
        i = _voxel(x, medium.lower[0], medium.per_metre[0], nx)
        j = _voxel(y, medium.lower[1], medium.per_metre[1], ny)
        k = _voxel(z, medium.lower[2], medium.per_metre[2], nz)
        return medium.sigma[i, j, k, channel]


class TrilinearData(NamedTuple):
    """The same, interpolated between the centres of voxels."""

    sigma: np.ndarray
    lower: np.ndarray
    per_metre: np.ndarray

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        s = medium.sigma
        i, i1, u = _centres(x, medium.lower[0], medium.per_metre[0], s.shape[0])
        j, j1, v = _centres(y, medium.lower[1], medium.per_metre[1], s.shape[1])
        k, k1, w = _centres(z, medium.lower[2], medium.per_metre[2], s.shape[2])
        c = channel
        near = (1 - v) * ((1 - u) * s[i, j, k, c] + u * s[i1, j, k, c]) + v * (
            (1 - u) * s[i, j1, k, c] + u * s[i1, j1, k, c]
        )
        far = (1 - v) * ((1 - u) * s[i, j, k1, c] + u * s[i1, j, k1, c]) + v * (
            (1 - u) * s[i, j1, k1, c] + u * s[i1, j1, k1, c]
        )
        return (1 - w) * near + w * far
