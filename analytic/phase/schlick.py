"""Schlick's phase function: f(mu) = (1 - k^2) / (4 pi (1 - k mu)^2), |k| < 1."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase, Array
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.proven.balls import rational
from fogproof.scene.phase import Schlick

SOURCE = "Blasi, Le Saec & Schlick 1993, Comput. Graph. Forum 12(3), 201"
METHOD = "closed form"


def _denominator(k: float, mu: np.ndarray) -> np.ndarray:
    """Return 1 - k mu as a sum of positive terms, relative error 1.5 eps."""
    a = abs(k)
    return (1 - a) + a * (1 - (mu if k >= 0 else -mu))


def pdf(phase: Schlick, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]; relative error 6 eps."""
    k = phase.k
    value = (1 - k) * (1 + k) / (4 * np.pi * _denominator(k, mu) ** 2)
    return value, 6 * EPS * value


def cdf(phase: Schlick, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu) = (1 - k)(1 + mu) / (2 (1 - k mu)); relative error 4 eps."""
    k = phase.k
    value = (1 - k) * (1 + mu) / (2 * _denominator(k, mu))
    return np.minimum(value, 1), 4 * EPS * value


def quantile(phase: Schlick, xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mu with F(mu) = xi; absolute error 5 eps times the distance to the nearer of -1 and 1, plus eps |mu|.

    With q = 1 - k + 2 k xi: 1 - mu = 2 (1 - k)(1 - xi)/q and 1 + mu = 2 (1 + k) xi/q.
    """
    k, a, eta = phase.k, abs(phase.k), 1 - xi
    forward, backward = (xi, eta) if k >= 0 else (eta, xi)
    q = (1 - a) + 2 * a * forward
    near, far = 2 * (1 - a) * backward / q, 2 * (1 + a) * forward / q
    value = np.where(near <= 1, 1 - near, far - 1)
    return value if k >= 0 else -value, 5 * EPS * np.minimum(near, far) + EPS * np.abs(value)


def mean_cosine(phase: Schlick) -> tuple[float, float]:
    """Return (k - (1 - k^2) atanh k)/k^2; its series sum_n 2 k^(2n-1)/(4 n^2 - 1) where that would cancel."""
    k = phase.k
    if abs(k) < 0.5:
        # Term n is below k^(2n-1)/n^2: at 30 terms what is left out is below 2^-59 k^3.
        value = math.fsum(2 * k ** (2 * n - 1) / (4 * n * n - 1) for n in range(1, 31))
        return value, 3 * EPS * abs(value)
    tail = (1 - k) * (1 + k) * math.atanh(k)
    return (k - tail) / k**2, EPS * (2 * abs(k - tail) + 4 * abs(tail)) / k**2


def airlight(phase: Schlick) -> AirlightPhase:
    """Return (1 - k^2) / (1 - k mu)^2, where 1 - k mu = ((1+k) w + (1-k) wt) / (w + wt)."""
    k = phase.k
    scale = (1 - k) * (1 + k)

    def factor(w: Array, wt: Array) -> Array:
        ratio = (w + wt) / ((1 + k) * w + (1 - k) * wt)
        return ratio * ratio * scale

    def slope(low: Array, _high: Array) -> tuple[Array, Array]:
        return np.full_like(low, 2 * abs(k) / math.sqrt(scale)), np.zeros_like(low)

    return AirlightPhase(factor, (1 - abs(k)) / (1 + abs(k)), (1 + abs(k)) / (1 - abs(k)), 8.0, slope)


def ball(phase: Schlick, mu: Any, _analytic: bool) -> Any:
    """Return 4 pi f, by the textbook formula."""
    k = rational(phase.k)
    return (1 - k * k) / (1 - k * mu) ** 2


def peak(phase: Schlick, _mu: Any) -> Any:
    """Return the greatest 4 pi f."""
    size = abs(rational(phase.k))
    return (1 + size) / (1 - size)
