"""Hazy and murky atmosphere: f(mu) = (1/2 + (n+1)/2 u^n)/(4 pi), u = (1 + mu)/2, n = 8 (hazy) and 32 (murky).

The lobe (n+1) u^n/(4 pi) integrates to 1, and so does the isotropic part: half of the light goes into each. (Lectures print
5 + u^8 and 17 + u^32; 5 and 17 are the peak values of the right bracket, not its constant.) n is a power of two.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase, Array
from fogproof.analytic.arithmetic.error_free import EPS

SOURCE = "Nishita, Miyawaki & Nakamae 1987, SIGGRAPH '87, 303, normalised"
METHOD = "closed form"


def _lobe(n: int, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return u and u^n, whose relative errors are eps/2 and (n/2 + 1) eps."""
    u = (1 + mu) / 2
    power = u
    for _ in range(n.bit_length() - 1):
        power = power * power
    return u, power


def pdf(n: int, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]; relative error 3 eps, and n eps of the lobe's part."""
    _, power = _lobe(n, mu)
    lobe = (n + 1) / (8 * np.pi) * power
    value = 1 / (8 * np.pi) + lobe
    return value, EPS * (3 * value + n * lobe)


def cdf(n: int, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu) = (u + u^(n+1))/2; relative error 2 eps, and n eps of the lobe's part."""
    u, power = _lobe(n, mu)
    lobe = u * power / 2
    value = u / 2 + lobe
    return value, EPS * (2 * value + n * lobe)


def mean_cosine(n: int) -> tuple[float, float]:
    """Return n/(2 (n + 2)): 2/5 and 8/17."""
    value = n / (2 * (n + 2))
    return value, EPS / 2 * value


def legendre_moments(n: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return half of n! (n+1)!/((n-l)! (n+l+1)!), and 1 for l = 0; relative error 2 l eps."""
    l = np.arange(1.0, count + 1)  # noqa: E741
    value = np.concatenate([[1.0], 0.5 * np.cumprod(np.maximum(n - l + 1, 0) / (n + l + 1))])
    return value, 2 * np.arange(count + 1) * EPS * value


def airlight(n: int) -> AirlightPhase:
    """Return 1/2 + (n+1)/2 u^n, u = wt / (w + wt)."""

    def factor(w: Array, wt: Array) -> Array:
        power = wt / (w + wt)
        for _ in range(n.bit_length() - 1):
            power = power * power
        return 0.5 + (n + 1) / 2 * power

    def slope(low: Array, _high: Array) -> tuple[Array, Array]:
        """|d log F / d theta| = n tan(theta/2) times the share of the lobe, which is below n / 2."""
        return np.full_like(low, n / 2), np.zeros_like(low)

    return AirlightPhase(factor, 0.5, 1 + n / 2, 3.0 * n, slope, degree=n)


def ball(n: int, mu: Any) -> Any:
    """Return 4 pi f."""
    return (1 + (n + 1) * ((1 + mu) / 2) ** n) / 2
