"""Henyey & Greenstein 1941: f(mu) = (1 - g^2) / (4 pi D^3), D^2 = 1 + g^2 - 2 g mu, whose mean cosine is g.

D is the distance from the point g on the axis to the point of the unit circle with cosine mu. Written as
D^2 = (1 - |g|)^2 + 2 |g| (1 - sign(g) mu), a sum of positive terms whose differences are exact or harmless, it keeps
its relative accuracy for every |g| < 1 and every mu; the distribution and its inverse have no division by g.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase, Array
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.proven.balls import flint, rational
from fogproof.scene.phase import HenyeyGreenstein

SOURCE = "Henyey & Greenstein 1941, Astrophys. J. 93, 70"
METHOD = "closed form"


def distance_squared(g: float, mu: np.ndarray) -> np.ndarray:
    """Return D^2 = 1 + g^2 - 2 g mu, relative error 2 eps."""
    a = abs(g)
    return (1 - a) ** 2 + 2 * a * (1 - (mu if g >= 0 else -mu))


def pdf(phase: HenyeyGreenstein, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]; relative error 8 eps."""
    g = phase.g
    D2 = distance_squared(g, mu)
    value = (1 - g) * (1 + g) / (4 * np.pi * (D2 * np.sqrt(D2)))
    return value, 8 * EPS * value


def most_near(phase: HenyeyGreenstein, field: str, radius: float) -> float:
    """Return what 4 pi |f| is at most, for all mu, at complex g within a radius of this one: (1 + r^2)/(1 - r)^3, r = |g| + radius.

    D^2 = (1 - g exp(i theta))(1 - g exp(-i theta)) is never smaller than (1 - r)^2 there.
    """
    r = abs(phase.g) + radius
    return (1 + r * r) / (1 - r) ** 3 if field == "g" and r < 1 else np.inf


def cdf(phase: HenyeyGreenstein, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu) = (1 - g)(1 + mu) / (D (1 + g + D)); relative error 6 eps.

    It is the textbook (1 - g^2)/(2 g) (1/D - 1/(1 + g)) with the factor g of the bracket divided out by hand.
    """
    g = phase.g
    D = np.sqrt(distance_squared(g, mu))
    value = (1 - g) * (1 + mu) / (D * ((1 + g) + D))
    return np.minimum(value, 1), 6 * EPS * value


def quantile(phase: HenyeyGreenstein, xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mu with F(mu) = xi; absolute error 10 eps times the distance to the nearer of -1 and 1, plus eps |mu|.

    With q = 1 - g + 2 g xi: 1 - mu = 2 (1-g)^2 (1-xi)(1 + g xi)/q^2 and 1 + mu = 2 (1+g)^2 xi (1 - g (1-xi))/q^2; the
    smaller of the two is the one to use.
    """
    g, a, eta = phase.g, abs(phase.g), 1 - xi
    forward, backward = (xi, eta) if g >= 0 else (eta, xi)
    q = (1 - a) + 2 * a * forward
    near = 2 * ((1 - a) / q) ** 2 * backward * (1 + a * forward)
    far = 2 * ((1 + a) / q) ** 2 * forward * ((1 - a) + a * forward)
    value = np.where(near <= 1, 1 - near, far - 1)
    return value if g >= 0 else -value, 10 * EPS * np.minimum(near, far) + EPS * np.abs(value)


def mean_cosine(phase: HenyeyGreenstein) -> tuple[float, float]:
    """Return g, exactly."""
    return phase.g, 0.0


def legendre_moments(phase: HenyeyGreenstein, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return g^l; relative error 2 eps, until it underflows."""
    with np.errstate(under="ignore"):
        value = phase.g ** np.arange(count + 1.0)
        lost = np.where(np.abs(value) < 1e-290, TINY, 0.0) if phase.g else 0.0
        return value, 2 * EPS * np.abs(value) + lost


def airlight(phase: HenyeyGreenstein) -> AirlightPhase:
    """Return (1 - g^2) / (1 + g^2 - 2 g mu)^(3/2), where 1 + g^2 - 2 g mu = ((1-g)^2 wt + (1+g)^2 w) / (w + wt)."""
    g = phase.g
    backward, forward, scale = (1 + g) ** 2, (1 - g) ** 2, (1 - g) * (1 + g)

    def factor(w: Array, wt: Array) -> Array:
        ratio = (w + wt) / (backward * w + forward * wt)
        return ratio * np.sqrt(ratio) * scale

    def slope(low: Array, high: Array) -> tuple[Array, Array]:
        """F is D^-3, D the distance of the direction from the point g of the axis: a turn moves it by |g| at most."""
        nearest = (1 - abs(g)) ** 2 + 2 * abs(g) * (1 - (high if g >= 0 else -low))
        return 3 * abs(g) / np.sqrt(nearest), np.zeros_like(low)

    least, most = (1 - abs(g)) / (1 + abs(g)) ** 2, (1 + abs(g)) / (1 - abs(g)) ** 2
    return AirlightPhase(factor, least, most, 8.0, slope)


def ball(phase: HenyeyGreenstein, mu: Any, analytic: bool) -> Any:
    """Return 4 pi f, by the textbook formula."""
    g = rational(phase.g)
    distance = 1 + g * g - 2 * g * mu
    return (1 - g * g) / (distance * flint().acb(distance).sqrt(analytic=analytic))


def peak(phase: HenyeyGreenstein, _mu: Any) -> Any:
    """Return the greatest 4 pi f."""
    size = abs(rational(phase.g))
    return (1 + size) / (1 - size) ** 2
