"""Henyey & Greenstein 1941: f(mu) = (1 - g^2) / (4 pi D^3), D^2 = 1 + g^2 - 2 g mu, whose mean cosine is g.

D is the distance from the point g on the axis to the point of the unit circle with cosine mu. Written as
D^2 = (1 - |g|)^2 + 2 |g| (1 - sign(g) mu), a sum of positive terms whose differences are exact or harmless, it keeps
its relative accuracy for every |g| < 1 and every mu; the distribution below has no division by g.
"""

from __future__ import annotations

import numpy as np

from fogproof.scene.phase_functions import HenyeyGreenstein

SOURCE = "Henyey & Greenstein 1941, Astrophys. J. 93, 70"
EPS = np.finfo(np.float64).eps


def distance_squared(g: float, mu: np.ndarray) -> np.ndarray:
    """Return D^2 = 1 + g^2 - 2 g mu, relative error 2 eps."""
    a = abs(g)
    return (1 - a) ** 2 + 2 * a * (1 - np.copysign(1.0, g) * mu)


def pdf(phase: HenyeyGreenstein, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]; relative error 8 eps."""
    g = phase.g
    D2 = distance_squared(g, mu)
    value = (1 - g) * (1 + g) / (4 * np.pi * (D2 * np.sqrt(D2)))
    return value, 8 * EPS * value


def cdf(phase: HenyeyGreenstein, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu) = (1 - g)(1 + mu) / (D (1 + g + D)); relative error 6 eps.

    It is the textbook (1 - g^2)/(2 g) (1/D - 1/(1 + g)) with the factor g of the bracket divided out by hand.
    """
    g = phase.g
    D = np.sqrt(distance_squared(g, mu))
    value = (1 - g) * (1 + mu) / (D * ((1 + g) + D))
    return np.minimum(value, 1), 6 * EPS * value
