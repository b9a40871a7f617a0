"""The extinction of a medium at a point, for kernels: one type of plain data and one function for each kind of medium.

`sigma_t(medium, channel, x, y, z)` is chosen by the type of `medium` when a kernel is compiled. Data have an axis for the
channels even when they are grey, so that every kernel serves both.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba.extending import overload

from fogproof.estimators.kernels.compiling import KERNEL_OPTIONS, inlined
from fogproof.estimators.kernels.data import (
    ChromaticFieldData,
    ExponentialData,
    FieldData,
    LayerData,
    LinearData,
    NearestData,
    NoiseData,
    TrilinearData,
)
from fogproof.estimators.kernels.noise import fractal_noise


def sigma_t(medium: NamedTuple, channel: int, x: float, y: float, z: float) -> float:
    """Return the extinction at a point [1/m]; only inside kernels."""
    raise NotImplementedError("sigma_t runs inside kernels only")


@inlined
def _voxel(x: float, lower: float, per_metre: float, n: int) -> int:
    return min(max(int(np.floor((x - lower) * per_metre)), 0), n - 1)


@inlined
def _centres(x: float, lower: float, per_metre: float, n: int) -> tuple[int, int, float]:
    u = min(max((x - lower) * per_metre - 0.5, 0.0), n - 1.0)
    i = int(u)
    return i, min(i + 1, n - 1), u - i


def _linear(medium: Any, channel: int, x: float, y: float, z: float) -> float:
    g = medium.gradient
    return max(0.0, medium.sigma_0[channel] + (g[channel, 0] * x + g[channel, 1] * y + g[channel, 2] * z))


def _exponential(medium: Any, channel: int, x: float, y: float, z: float) -> float:
    k = medium.rate
    return medium.sigma_0[channel] * np.exp(k[channel, 0] * x + k[channel, 1] * y + k[channel, 2] * z)


def _layers(medium: Any, channel: int, x: float, y: float, z: float) -> float:
    height = medium.axis[0] * x + medium.axis[1] * y + medium.axis[2] * z
    i = np.searchsorted(medium.boundaries, height, side="right") - 1
    return medium.sigma[i, channel] if 0 <= i < len(medium.sigma) else 0.0


def _nearest(medium: Any, channel: int, x: float, y: float, z: float) -> float:
    nx, ny, nz, _ = medium.sigma.shape
    i = _voxel(x, medium.lower[0], medium.per_metre[0], nx)
    j = _voxel(y, medium.lower[1], medium.per_metre[1], ny)
    k = _voxel(z, medium.lower[2], medium.per_metre[2], nz)
    return medium.sigma[i, j, k, channel]


def _trilinear(medium: Any, channel: int, x: float, y: float, z: float) -> float:
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


def _noise(medium: Any, channel: int, x: float, y: float, z: float) -> float:
    return medium.density * fractal_noise(medium.table, medium.frequency, medium.octaves, medium.gain, x, y, z)


def _field(medium: Any, channel: int, x: float, y: float, z: float) -> float:
    return medium.function(x, y, z)


def _chromatic_field(medium: Any, channel: int, x: float, y: float, z: float) -> float:
    return medium.function(x, y, z, channel)


_FUNCTIONS: dict[type, Callable[..., float]] = {
    LinearData: _linear,
    ExponentialData: _exponential,
    LayerData: _layers,
    NearestData: _nearest,
    TrilinearData: _trilinear,
    NoiseData: _noise,
    FieldData: _field,
    ChromaticFieldData: _chromatic_field,
}


@overload(sigma_t, jit_options={"forceinline": True, **KERNEL_OPTIONS})
def _choose(medium: Any, channel: int, x: float, y: float, z: float) -> Any:
    return _FUNCTIONS[medium.instance_class]
