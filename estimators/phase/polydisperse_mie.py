"""Lorenz-Mie scattering by spheres of many sizes, as a sum of cosines of the angle, which is sampled by inversion.

The sizes are taken at equal steps of ln d, a rule that is exact to rounding for smooth laws, and the steps are halved until nothing
changes; each sphere's amplitudes come from the coefficients of `mie`. Only spheres without absorption, whose resonances are narrow,
need many.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.phase import mie
from fogproof.estimators.phase.cosine_series import CosineSeries
from fogproof.estimators.phase.polar import Polar
from fogproof.scene.phase import Mie, PolydisperseMie

FEWEST, MOST = 256, 8192
"""Steps of ln d."""

SAME = 1e-9
"""Change of the density by halved steps, relative to its greatest value, with which halving ends."""

BLOCK = 256


def density(phase: PolydisperseMie, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]."""
    return series(phase).density(versine, coversine)


def polar(phase: PolydisperseMie, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf."""
    return series(phase).polar(xi)


def _numbers(phase: PolydisperseMie, t: np.ndarray) -> np.ndarray:
    """Return how many spheres there are for each ln d, at t = ln d/a."""
    b = phase.effective_variance
    if phase.distribution == "gamma":
        return np.exp((1 - 2 * b) / b * t - np.expm1(t) / b)
    width = math.log(1 + b)
    return np.exp(-((t + 2.5 * width) ** 2) / (2 * width))


def _range(phase: PolydisperseMie) -> tuple[float, float]:
    """Return from which to which t = ln d/a the spheres' areas are above e^-36 of the greatest."""
    t = np.linspace(-40, 6, 100_001)
    with np.errstate(divide="ignore", under="ignore"):
        area = np.log(_numbers(phase, t)) + 2 * t
    there = t[area > area.max() - 36]
    return float(there[0]), float(there[-1])


@lru_cache(maxsize=16)
def series(phase: PolydisperseMie) -> CosineSeries:
    """Return the sum of cosines."""
    low, high = _range(phase)
    size = math.pi * phase.effective_diameter * math.exp(high) * phase.medium_index / phase.wavelength
    if size > mie.LARGEST_SIZE:
        limit = f"need size parameters <= {mie.LARGEST_SIZE:g}"
        raise UnsupportedError(f"Lorenz-Mie directions {limit}, the largest of these spheres has {size:.6g}", "phase")
    N = math.ceil(size + 4.05 * size ** (1 / 3) + 9)
    n = np.arange(1, N + 1)[:, None]
    scale = (2 * n + 1) / (n * (n + 1))
    pi, tau = (scale * x for x in _angular(np.cos(np.pi * (np.arange(2 * N + 2) + 0.5) / (2 * N + 2)), N))
    steps, t = FEWEST, np.linspace(low, high, FEWEST + 1)
    total = _light(phase, t, pi, tau)
    while steps < MOST:
        step = (high - low) / steps
        more = total + _light(phase, low + step * (np.arange(steps) + 0.5), pi, tau)
        changed = np.max(np.abs(more / 2 - total))
        total, steps = more, 2 * steps
        if changed <= SAME * np.max(total) / 2:
            break
    return CosineSeries(total / np.max(total))


def _light(phase: PolydisperseMie, t: np.ndarray, pi: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """Return the sum of |S1|^2 + |S2|^2 over spheres at t = ln d/a, each as often as there are."""
    total = np.zeros(pi.shape[1])
    for block in np.array_split(t, math.ceil(len(t) / BLOCK)):
        a, b = np.zeros((2, len(block), len(pi)), complex)
        for i, d in enumerate(phase.effective_diameter * np.exp(block)):
            pair = mie.coefficients(Mie(d, phase.wavelength, phase.refractive_index, phase.medium_index))
            a[i, : len(pair[0])], b[i, : len(pair[1])] = pair
        total += _numbers(phase, block) @ (np.abs(a @ pi + b @ tau) ** 2 + np.abs(a @ tau + b @ pi) ** 2)
    return total


def _angular(mu: np.ndarray, N: int) -> tuple[np.ndarray, np.ndarray]:
    """Return pi_n and tau_n (Bohren & Huffman 1983, eq. 4.47), (N, m) each."""
    pi, tau = np.zeros((2, N + 1, mu.size))
    pi[1] = 1
    for n in range(2, N + 1):
        pi[n] = ((2 * n - 1) * mu * pi[n - 1] - n * pi[n - 2]) / (n - 1)
    order = np.arange(1, N + 1)[:, None]
    tau[1:] = order * mu * pi[1:] - (order + 1) * pi[:-1]
    return pi[1:], tau[1:]
