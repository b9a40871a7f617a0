"""A phase function between directions, from its Legendre moments; what points forward beyond them counts as not scattered.

Of chi_0 … chi_L the share F = chi_L is taken for a delta function straight ahead and the rest for the scattering:

    chi_l -> (chi_l - F)/(1 - F),    tau -> tau (1 - c F),    1 - c -> (1 - c)/(1 - c F),

after which all moments up to L are those given, and the higher ones F instead of what they are.
Source: Wiscombe 1977, The delta-M method, Journal of the Atmospheric Sciences 34.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.multiple.doubling import SIDE, ScatteringLayer
from fogproof.analytic.multiple.slab_modes import legendre


class Scaled(NamedTuple):
    """Albedo, absorbed = 1 - albedo and thickness (b,) with the forward share taken out, and the moments left (L,)."""

    albedo: np.ndarray
    absorbed: np.ndarray
    tau: np.ndarray
    chi: np.ndarray


def scaled(c: np.ndarray, tau: np.ndarray, chi: np.ndarray) -> Scaled:
    """Return slabs of albedo c (b,) and thickness tau (b,) whose last moment of chi (L + 1,) is taken out."""
    forward = chi[-1]
    rest = (1 - c) + c * (1 - forward)
    return Scaled(c * (1 - forward) / rest, (1 - c) / rest, tau * rest, (chi[:-1] - forward) / (1 - forward))


def medium(slabs: Scaled, mu: np.ndarray, w: np.ndarray, aside: np.ndarray) -> ScatteringLayer:
    """Return the scattering, averaged over azimuth, at nodes mu of weights w and at directions `aside` that are no nodes."""
    n = len(mu)
    P = legendre(len(slabs.chi) - 1, np.concatenate([mu, aside]))
    # Light is neither lost nor made: even polynomials are orthogonal to 1 under the rule, to the last digit.
    P[2::2] -= (P[2::2, :n] @ w)[:, None] / np.sum(w)
    weighted = (slabs.chi * (2 * np.arange(len(slabs.chi)) + 1))[:, None] * P
    even, odd = P[0::2].T @ weighted[0::2], P[1::2].T @ weighted[1::2]
    half = slabs.albedo[:, None, None] / 2
    return ScatteringLayer(
        np.concatenate([mu, aside]),
        np.concatenate([w / np.sum(w), np.full(len(aside), SIDE)]),
        half * (even + odd),
        half * (even - odd),
        slabs.absorbed,
        np.ones(len(slabs.tau), bool),
    )


def associated_legendre(m: int, highest: int, mu: np.ndarray) -> np.ndarray:
    """Return sqrt((l - m)!/(l + m)!) P_l^m for l = 0 … highest (highest + 1, v), without Condon and Shortley's sign; 0 for l < m.

    Source: Abramowitz & Stegun 1964, 8.5.3.
    """
    P = np.zeros((highest + 1, len(mu)))
    if m > highest:
        return P
    sine = np.sqrt((1 - mu) * (1 + mu))
    P[m] = 1.0
    for j in range(1, m + 1):
        P[m] *= sine * np.sqrt((2 * j - 1) / (2 * j))
    if m < highest:
        P[m + 1] = np.sqrt(2 * m + 1) * mu * P[m]
    for n in range(m + 1, highest):
        P[n + 1] = ((2 * n + 1) * mu * P[n] - np.sqrt((n - m) * (n + m)) * P[n - 1]) / np.sqrt(
            (n + 1 - m) * (n + 1 + m)
        )
    return P


def fourier_medium(
    slab: Scaled, mu: np.ndarray, w: np.ndarray, aside: np.ndarray, orders: np.ndarray
) -> ScatteringLayer:
    """Return the scattering of one slab in Fourier modes (b,) of the azimuth, at nodes mu of weights w and at directions aside."""
    n = len(mu)
    every, last = np.concatenate([mu, aside]), len(slab.chi) - 1
    forward, backward = np.empty((2, len(orders), len(every), len(every)))
    sign = (-1.0) ** np.arange(last + 1)
    for i, m in enumerate(orders.tolist()):
        P = associated_legendre(m, last, every)
        if m == 0:
            P[2::2] -= (P[2::2, :n] @ w)[:, None] / np.sum(w)
        weighted = ((2 * np.arange(last + 1) + 1) * slab.chi)[m:, None] * P[m:]
        forward[i] = P[m:].T @ weighted
        backward[i] = (P[m:] * (sign[m:] * (-1) ** m)[:, None]).T @ weighted
    half = float(slab.albedo[0]) / 2
    weights = np.concatenate([w / np.sum(w), np.full(len(aside), SIDE)])
    absorbed = np.full(len(orders), slab.absorbed[0])
    return ScatteringLayer(every, weights, half * forward, half * backward, absorbed, orders == 0)
