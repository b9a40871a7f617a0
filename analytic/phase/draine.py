"""Draine 2003: f(mu) = HG(mu) (1 + alpha mu^2) / (1 + alpha (1 + 2 g^2)/3); Cornette & Shanks 1992 is alpha = 1.

The distribution needs int (1 + m)^j HG dm, j = 0, 1, 2. With D as for Henyey-Greenstein and s = (1 + g - D)/g =
2 (1 + mu)/(1 + g + D) these are, without a division by g and with positive factors only,

    M0 = (1-g)(1+g) s / (2 (1+g) D),   M1 = (1-g)(1+g) s^2 / (4 D),   M2 = (1-g)(1+g) s^3 (3 (1+g) + D) / (24 D),

and int m^2 HG = M0 - 2 M1 + M2 loses at most a digit. alpha enters as beta = alpha/(1 + alpha), which cannot overflow.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase, Array
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.phase import henyey_greenstein
from fogproof.analytic.phase.henyey_greenstein import distance_squared
from fogproof.analytic.proven.balls import rational
from fogproof.scene.phase import CornetteShanks, Draine, HenyeyGreenstein

SOURCE = "Draine 2003, Astrophys. J. 598, 1017, eq. 4"
METHOD = "closed form"


def _parameters(phase: CornetteShanks | Draine) -> tuple[float, float, float, float]:
    """Return g, 1 - beta, beta and the mean of (1 - beta) + beta mu^2 over HG; relative errors 0, 1, 1 and 4 eps."""
    g, alpha = phase.g, phase.alpha
    plain, beta = 1 / (1 + alpha), alpha / (1 + alpha)
    return g, plain, beta, plain + beta * (1 + 2 * g * g) / 3


def pdf(phase: CornetteShanks | Draine, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]; relative error 15 eps."""
    g, plain, beta, mean = _parameters(phase)
    D2 = distance_squared(g, mu)
    value = (1 - g) * (1 + g) * (plain + beta * mu * mu) / (4 * np.pi * mean * (D2 * np.sqrt(D2)))
    return value, 15 * EPS * value


def cdf(phase: CornetteShanks | Draine, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu); error 15 eps times M0 (1 - beta) + (M0 + 2 M1 + M2) beta, of which F is at least a ninth or so."""
    g, plain, beta, mean = _parameters(phase)
    D0, D = 1 + g, np.sqrt(distance_squared(g, mu))
    s = 2 * (1 + mu) / (D0 + D)
    common = (1 - g) * s / D
    M0 = common / 2
    M1 = common * (D0 * s) / 4
    M2 = common * (D0 * s) * s * (3 * D0 + D) / 24
    value = (plain * M0 + beta * (M0 - 2 * M1 + M2)) / mean
    error = 15 * EPS * (plain * M0 + beta * (M0 + 2 * M1 + M2)) / mean
    return np.clip(value, 0, 1), error


def mean_cosine(phase: CornetteShanks | Draine) -> tuple[float, float]:
    """Return g (1 + alpha (3 + 2 g^2)/5) / (1 + alpha (1 + 2 g^2)/3); relative error 8 eps."""
    g, plain, beta, mean = _parameters(phase)
    value = g * (plain + beta * (3 + 2 * g * g) / 5) / mean
    return value, 8 * EPS * abs(value)


def legendre_moments(phase: CornetteShanks | Draine, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return chi_l from the moments g^l of Henyey-Greenstein; error 12 eps of a sum of positive terms.

    mu P_l = ((l + 1) P_(l+1) + l P_(l-1))/(2 l + 1), applied twice, gives the moments of mu^2 HG from g^(l-2), g^l, g^(l+2).
    """
    g, plain, beta, mean = _parameters(phase)
    l = np.arange(count + 1.0)  # noqa: E741
    h = g**l
    above = (l + 1) * (l + 2) / ((2 * l + 1) * (2 * l + 3))
    same = ((l + 1) ** 2 / (2 * l + 3) + l**2 / np.maximum(2 * l - 1, 1)) / (2 * l + 1)
    below = l * (l - 1) / ((2 * l + 1) * np.maximum(2 * l - 1, 1))
    before = np.concatenate([[0.0, 0.0], h])[: count + 1]
    value = (plain * h + beta * (above * (h * g * g) + same * h + below * before)) / mean
    return value, 12 * EPS * np.abs(value)


def airlight(phase: CornetteShanks | Draine) -> AirlightPhase:
    """Return Henyey-Greenstein times (1 + alpha mu^2) / (1 + alpha (1 + 2 g^2)/3)."""
    return airlight_form(phase.g, phase.alpha)


def airlight_form(g: float, alpha: float) -> AirlightPhase:
    """Return the same for the parameters."""
    lobe = henyey_greenstein.airlight(HenyeyGreenstein(g))
    assert lobe.factor is not None
    hg, scale = lobe.factor, 1 / (1 + alpha * (1 + 2 * g * g) / 3)

    def factor(w: Array, wt: Array) -> Array:
        mu = (wt - w) / (wt + w)
        bracket: Array = (1 + alpha * (mu * mu)) * scale
        return bracket if g == 0 else bracket * hg(w, wt)

    def slope(low: Array, high: Array) -> tuple[Array, Array]:
        return lobe.slope(low, high)[0] + alpha / math.sqrt(1 + alpha), np.zeros_like(low)

    most = lobe.peak * (1 + alpha) * scale
    return AirlightPhase(factor, lobe.floor * scale, most, 6.0 if g == 0 else 16.0, slope, degree=2)


def ball(phase: CornetteShanks | Draine, mu: Any, analytic: bool) -> Any:
    """Return 4 pi f, by the textbook formula."""
    g, alpha = rational(phase.g), rational(phase.alpha)
    lobe = henyey_greenstein.ball(HenyeyGreenstein(phase.g), mu, analytic)
    return lobe * (1 + alpha * mu * mu) / (1 + alpha * (1 + 2 * g * g) / 3)


def peak(phase: CornetteShanks | Draine, _mu: Any) -> Any:
    """Return an upper bound of 4 pi f."""
    return (1 + rational(phase.alpha)) * henyey_greenstein.peak(HenyeyGreenstein(phase.g), _mu)
