"""Perlin's improved gradient noise (Perlin 2002, "Improving Noise") summed over octaves, for kernels."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.estimators.kernels.compiling import inlined

HIGHEST = 1.0364
"""Above the greatest value of |noise|: 1.03635, reached where all eight gradients point at one place near a cell's centre."""


@inlined
def _fade(t: float) -> float:
    return t * t * t * (t * (t * 6 - 15) + 10)


@inlined
def _gradient(code: int, x: float, y: float, z: float) -> float:
    """Return the dot product with one of twelve directions from the centre of a cube to its edges, four of them twice."""
    h = code & 15
    u = x if h < 8 else y
    v = y if h < 4 else (x if h == 12 or h == 14 else z)
    return (u if h & 1 == 0 else -u) + (v if h & 2 == 0 else -v)


@inlined
def _noise(table: np.ndarray, x: float, y: float, z: float) -> float:
    """Return the noise at a point, between -HIGHEST and HIGHEST, with cells of edge 1."""
    fx, fy, fz = np.floor(x), np.floor(y), np.floor(z)
    i, j, k = int(fx) & 255, int(fy) & 255, int(fz) & 255
    x, y, z = x - fx, y - fy, z - fz
    u, v, w = _fade(x), _fade(y), _fade(z)
    a, b = table[i] + j, table[i + 1] + j
    aa, ab, ba, bb = table[a] + k, table[a + 1] + k, table[b] + k, table[b + 1] + k
    g000, g100 = _gradient(table[aa], x, y, z), _gradient(table[ba], x - 1, y, z)
    g010, g110 = _gradient(table[ab], x, y - 1, z), _gradient(table[bb], x - 1, y - 1, z)
    g001, g101 = _gradient(table[aa + 1], x, y, z - 1), _gradient(table[ba + 1], x - 1, y, z - 1)
    g011, g111 = _gradient(table[ab + 1], x, y - 1, z - 1), _gradient(table[bb + 1], x - 1, y - 1, z - 1)
    near = (1 - v) * (g000 + u * (g100 - g000)) + v * (g010 + u * (g110 - g010))
    far = (1 - v) * (g001 + u * (g101 - g001)) + v * (g011 + u * (g111 - g011))
    return near + w * (far - near)


@inlined
def fractal_noise(
    table: np.ndarray, frequency: float, octaves: int, gain: float, x: float, y: float, z: float
) -> float:
    """Return a number in [0, 1]: octaves of noise, each twice as fine as the one before and `gain` times as strong."""
    total, most, weight = 0.0, 0.0, 1.0
    for _ in range(octaves):
        total += weight * _noise(table, x * frequency, y * frequency, z * frequency)
        most += weight * HIGHEST
        weight *= gain
        frequency *= 2
    return 0.5 + 0.5 * total / most


class NoiseData(NamedTuple):
    """Fractal noise, see `fogproof.estimators.FractalNoise`."""

    density: float
    frequency: float
    octaves: int
    gain: float
    table: np.ndarray

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        return medium.density * fractal_noise(medium.table, medium.frequency, medium.octaves, medium.gain, x, y, z)
