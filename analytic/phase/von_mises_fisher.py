"""Von Mises-Fisher: f(mu) = a exp(-a (1 - mu))/(2 pi (1 - exp(-2 a))) for a = |kappa|, mirrored where kappa < 0.

The hyperbolic functions of the textbook are written with expm1, which neither overflows nor cancels.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.proven.balls import flint, rational
from fogproof.scene.phase import VonMisesFisher

SOURCE = "Fisher 1953, Proc. R. Soc. A 217, 295"
METHOD = "closed form"

NEARLY_ALL = 40.0
"""Steps of the continued fraction beyond the last moment where kappa is small; it grows as sqrt(kappa)."""


def _height(a: float) -> float:
    """Return a/(1 - exp(-2 a)), 1/2 at a = 0; relative error 2 eps."""
    return a / -math.expm1(-2 * a) if a > 0 else 0.5


def pdf(phase: VonMisesFisher, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]; relative error (6 + 2 a (1 - mu)) eps, of the rounded exponent."""
    a = abs(phase.kappa)
    with np.errstate(under="ignore"):
        exponent = a * (1 - (mu if phase.kappa >= 0 else -mu))
        value = _height(a) / (2 * np.pi) * np.exp(-exponent)
        return value, (6 + 2 * exponent) * EPS * value + (1 + _height(a)) * TINY


def cdf(phase: VonMisesFisher, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu) = (1 - exp(-a (1 + mu)))/(1 - exp(-2 a)), times exp(-a (1 - mu)) for kappa > 0.

    Relative error (8 + 2 a (1 - mu)) eps.
    """
    a = abs(phase.kappa)
    if a == 0:
        return (1 + mu) / 2, EPS * (1 + mu)
    with np.errstate(under="ignore"):
        value = np.expm1(-a * (1 + mu)) / math.expm1(-2 * a)
        exponent = a * (1 - mu) if phase.kappa > 0 else np.zeros_like(mu)
        value = value * np.exp(-exponent)
        return np.minimum(value, 1), (8 + 2 * exponent) * EPS * value + TINY


def quantile(phase: VonMisesFisher, xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mu with F(mu) = xi; absolute error 16 eps of its distance from the peak, plus 4 eps/max(1, a) and eps |mu|.

    1 - mu = -log(xi + (1 - xi) exp(-2 a))/a for kappa > 0, by log1p where xi is large or a small.
    """
    a = abs(phase.kappa)
    if a == 0:
        return 2 * xi - 1, 2 * EPS * xi + EPS
    inner, outer = (xi, 1 - xi) if phase.kappa > 0 else (1 - xi, xi)
    with np.errstate(under="ignore", divide="ignore"):
        by_share = -np.log1p(outer * math.expm1(-2 * a)) / a
        by_rest = -np.log(np.maximum(inner + outer * math.exp(-2 * a), TINY)) / a
    versine = np.minimum(np.where((outer <= 0.5) | (a < 1), by_share, by_rest), 2.0)
    versine = np.where(inner == 0, 2.0, versine)
    mu = 1 - versine
    error = 16 * EPS * versine + 4 * EPS / max(1.0, a) + EPS * np.abs(mu)
    return (mu if phase.kappa > 0 else -mu), error


def mean_cosine(phase: VonMisesFisher) -> tuple[float, float]:
    """Return coth kappa - 1/kappa."""
    value, error = legendre_moments(phase, 1)
    return float(value[1]), float(error[1])


def legendre_moments(phase: VonMisesFisher, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return chi_l = i_l(kappa)/i_0(kappa), modified spherical Bessel functions, and what rounding adds up to."""
    a = abs(phase.kappa)
    value, error = _upwards(a, count) if a >= max(count * count, 1) else _downwards(a, count)
    error[0], error[1:] = 0.0, error[1:] + TINY
    return np.where((np.arange(count + 1) % 2 == 1) & (phase.kappa < 0), -value, value), error


def _upwards(a: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return chi_l by chi_(l+1) = chi_(l-1) - (2 l + 1)/a chi_l, for count^2 <= a: the errors grow by less than e."""
    value = np.ones(count + 1)
    value[1:2] = 1 / math.tanh(a) - 1 / a
    for l in range(1, count):  # noqa: E741
        value[l + 1] = value[l - 1] - (2 * l + 1) / a * value[l]
    return value, 6 * EPS * (np.arange(count + 1) + 1)


def _downwards(a: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return chi_l as a product of r_l = i_(l+1)/i_l = a/(2 l + 3 + a r_(l+1)).

    It is followed down from two starts that enclose it (Amos 1974, Math. Comput. 28, 239, eqs. 9 and 11); what they still
    differ by counts, and three roundings a step, of which the next step keeps r^2.
    """
    order = count + math.ceil(NEARLY_ALL + math.sqrt(NEARLY_ALL * a))
    r = np.array([a / (order + 1 + math.hypot(a, order + 0.5 + shift)) for shift in (1.5, 0.5)])
    ratios, noise, rounding = np.ones((count + 1, 2)), np.zeros(count + 1), 0.0
    for l in range(order - 1, -1, -1):  # noqa: E741
        r = a / ((2 * l + 3) + a * r)
        rounding = 3 * EPS + float(r.max()) ** 2 * rounding
        if l < count:
            ratios[l + 1], noise[l + 1] = r, rounding + EPS
    with np.errstate(under="ignore"):
        both = np.cumprod(ratios, axis=0)
        return both[:, 0], np.abs(both[:, 1] - both[:, 0]) + np.cumsum(noise) * both[:, 0]


def ball(phase: VonMisesFisher, mu: Any, _analytic: bool) -> Any:
    """Return 4 pi f = kappa exp(kappa mu)/sinh kappa."""
    kappa = rational(phase.kappa)
    arb, acb = flint().arb, flint().acb
    return acb(1) if kappa == 0 else (acb(kappa) * mu).exp() * kappa / arb(kappa).sinh()


def peak(phase: VonMisesFisher, _mu: Any) -> Any:
    """Return the greatest 4 pi f."""
    a = abs(rational(phase.kappa))
    return 1 if a == 0 else 2 * a / (1 - (-2 * flint().arb(a)).exp())
