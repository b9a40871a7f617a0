"""Rayleigh 1871: f(mu) = 3/(16 pi) (1 + mu^2), for unpolarised light and particles much smaller than the wavelength."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.phase import draine
from fogproof.scene.phase import Rayleigh

SOURCE = "Rayleigh 1871, Phil. Mag. 41, 107"
METHOD = "closed form"


def pdf(_phase: Rayleigh, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]; relative error 3 eps."""
    value = 3 / (16 * np.pi) * (1 + mu * mu)
    return value, 3 * EPS * value


def cdf(_phase: Rayleigh, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu) = (4 + 3 mu + mu^3)/8, factored as (1 + mu)(4 - mu (1 - mu))/8; relative error 2 eps."""
    value = (1 + mu) * (4 - mu * (1 - mu)) / 8
    return value, 2 * EPS * value


def quantile(_phase: Rayleigh, xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return mu = 2 sinh(asinh(4 xi - 2)/3), the real root of mu^3 + 3 mu = 8 xi - 4; relative error 10 eps."""
    value = 2 * np.sinh(np.arcsinh(4 * xi - 2) / 3)
    return np.clip(value, -1, 1), 10 * EPS * np.abs(value)


def mean_cosine(_phase: Rayleigh) -> tuple[float, float]:
    """Return 0, exactly."""
    return 0.0, 0.0


def legendre_moments(_phase: Rayleigh, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return 1, 0, 1/10, 0 …; relative error eps/2."""
    value = np.pad([1.0, 0.0, 0.1], (0, max(count - 2, 0)))[: count + 1]
    return value, np.where(np.arange(count + 1) == 2, 0.5 * EPS * value, 0.0)


def airlight(_phase: Rayleigh) -> AirlightPhase:
    """Return 3/4 (1 + mu^2), which is Draine's function with g = 0 and alpha = 1."""
    return draine.airlight_form(0.0, 1.0)


def ball(_phase: Rayleigh, mu: Any, _analytic: bool) -> Any:
    """Return 4 pi f."""
    return 3 * (1 + mu * mu) / 4


def peak(_phase: Rayleigh, _mu: Any) -> int:
    """Return an upper bound of 4 pi f, 3/2."""
    return 2
