"""Lorenz-Mie scattering of unpolarised light by a sphere (Bohren & Huffman 1983): exact values, and a table to sample from.

The series is exact but its cdf is no function to invert sample by sample: directions are drawn from a table that is linear
between values of the series, and what an estimator multiplies by is the ratio of the two, close to 1.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.phase import tabulated
from fogproof.estimators.phase.polar import Polar
from fogproof.scene import Mie, Tabulated

LARGEST_SIZE = 1000.0
"""Size parameter up to which the table is built; the cost of one value grows with it."""

_NODES_PER_ORDER = 24  # the series of N orders is a trigonometric polynomial of degree 2 N in the angle


def density(phase: Mie, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function f [1/sr], not its table; the error is about 1e-14 x sqrt(f f(1)) for the size parameter x."""
    return _intensity(phase, 0.5 * (coversine - versine)).astype(versine.dtype)


def cosines(phase: Mie, xi: np.ndarray, out: np.ndarray) -> None:
    """Write forward cosines with the density of the table."""
    tabulated.cosines(table(phase), xi, out)


def polar(phase: Mie, xi: np.ndarray) -> Polar:
    """Return scattering angles and the pdf of the table they are drawn from."""
    return tabulated.polar(table(phase), xi)


@lru_cache(maxsize=16)
def table(phase: Mie) -> Tabulated:
    """Return the table that directions are drawn from, nodes at equal angles."""
    a, _ = coefficients(phase)
    mu = -np.cos(np.linspace(0, np.pi, _NODES_PER_ORDER * len(a) + 1))
    mu[0], mu[-1] = -1, 1
    return Tabulated.normalised(mu, _intensity(phase, mu))


@lru_cache(maxsize=16)
def coefficients(phase: Mie) -> tuple[np.ndarray, np.ndarray]:
    """Return a_n, b_n for n = 1 … N (their eq. 4.88): logarithmic derivatives downwards, spherical Bessel functions of x."""
    from scipy.special import spherical_jn, spherical_yn

    x = math.pi * phase.diameter * phase.medium_index / phase.wavelength
    if x > LARGEST_SIZE:
        raise UnsupportedError(f"Lorenz-Mie directions need a size parameter <= {LARGEST_SIZE:g}, got {x:.6g}", "phase")
    m = phase.refractive_index / phase.medium_index
    N = math.ceil(x + 4.05 * x ** (1 / 3) + 8)
    z = m * x
    D = np.zeros(N + 1, complex)
    derivative = 0j
    start = max(N, abs(z))
    for n in range(math.ceil(start + 8 * start ** (1 / 3)) + 16, 0, -1):
        derivative = n / z - 1 / (derivative + n / z)
        if n <= N + 1:
            D[n - 1] = derivative
    orders = np.arange(N + 1)
    psi = x * spherical_jn(orders, x)
    xi = psi + 1j * x * spherical_yn(orders, x)
    electric, magnetic = D[1:] / m + orders[1:] / x, m * D[1:] + orders[1:] / x
    a = (electric * psi[1:] - psi[:-1]) / (electric * xi[1:] - xi[:-1])
    b = (magnetic * psi[1:] - psi[:-1]) / (magnetic * xi[1:] - xi[:-1])
    return a, b


def _intensity(phase: Mie, mu: np.ndarray) -> np.ndarray:
    """Return (|S1|^2 + |S2|^2)/2 divided by its integral over the sphere, at cosines mu (n,)."""
    a, b = coefficients(phase)
    mu = mu.astype(np.float64)
    S1, S2 = np.zeros((2, *mu.shape), complex)
    before, pi = np.zeros_like(mu), np.ones_like(mu)
    for n in range(1, len(a) + 1):
        tau = n * mu * pi - (n + 1) * before
        scale = (2 * n + 1) / (n * (n + 1))
        S1 += scale * (a[n - 1] * pi + b[n - 1] * tau)
        S2 += scale * (a[n - 1] * tau + b[n - 1] * pi)
        before, pi = pi, ((2 * n + 1) * mu * pi - (n + 1) * before) / n
    norm = 4 * np.pi * float((2 * np.arange(1, len(a) + 1) + 1) @ (np.abs(a) ** 2 + np.abs(b) ** 2))
    return (np.abs(S1) ** 2 + np.abs(S2) ** 2) / norm
