"""A sum of Legendre polynomials: values by Bonnet's recurrence on differences, the distribution by parts, moments as given."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase
from fogproof.analytic.phase import legendre_sums
from fogproof.analytic.proven.balls import flint, rational
from fogproof.scene.phase import LegendreSeries

SOURCE = "Chandrasekhar 1960, Radiative Transfer, section 48"
METHOD = "sum of Legendre polynomials"


def _moments(phase: LegendreSeries) -> tuple[np.ndarray, np.ndarray]:
    chi = np.array(phase.moments)
    return chi, np.zeros_like(chi)


def pdf(phase: LegendreSeries, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]; error some N/8 eps of the sum of all terms' sizes."""
    return legendre_sums.density(*_moments(phase), (1 - mu) / 2, (1 + mu) / 2)


def cdf(phase: LegendreSeries, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu)."""
    return legendre_sums.cdf(*_moments(phase), mu)


def mean_cosine(phase: LegendreSeries) -> tuple[float, float]:
    """Return chi_1, exactly."""
    return (phase.moments[1] if len(phase.moments) > 1 else 0.0), 0.0


def legendre_moments(phase: LegendreSeries, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return chi_0 … chi_count, exactly."""
    return legendre_sums.moments(*_moments(phase), count)


def airlight(phase: LegendreSeries) -> AirlightPhase:
    """Return 4 pi f."""
    return legendre_sums.airlight(*_moments(phase))


def ball(phase: LegendreSeries, mu: Any, _analytic: bool) -> Any:
    """Return 4 pi f, by Bonnet's recurrence."""
    mu = flint().acb(mu)
    before, here, total = flint().acb(0), flint().acb(1), flint().acb(0)
    for l, chi in enumerate(phase.moments):  # noqa: E741
        total += (2 * l + 1) * rational(chi) * here
        before, here = here, ((2 * l + 1) * mu * here - l * before) / (l + 1)
    return total


def peak(phase: LegendreSeries, _mu: Any) -> Any:
    """Return an upper bound of 4 pi f: |P_l| <= 1."""
    return sum((2 * l + 1) * abs(rational(chi)) for l, chi in enumerate(phase.moments))  # noqa: E741
