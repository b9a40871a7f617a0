"""Isotropic scattering: f = 1/(4 pi) in every direction."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase, no_slope
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.scene.phase import Isotropic

SOURCE = "uniform distribution on the sphere"
METHOD = "closed form"


def pdf(_phase: Isotropic, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) = 1/(4 pi) [1/sr]; relative error eps."""
    value = np.full_like(mu, 1 / (4 * np.pi))
    return value, EPS * value


def cdf(_phase: Isotropic, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu) = (1 + mu)/2; relative error eps/2."""
    value = (1 + mu) / 2
    return value, EPS / 2 * value


def quantile(_phase: Isotropic, xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return mu = 2 xi - 1; relative error eps/2."""
    value = 2 * xi - 1
    return value, EPS / 2 * np.abs(value)


def mean_cosine(_phase: Isotropic) -> tuple[float, float]:
    """Return 0, exactly."""
    return 0.0, 0.0


def legendre_moments(_phase: Isotropic, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return 1, 0, 0 …, exactly."""
    return np.eye(count + 1)[0], np.zeros(count + 1)


def airlight(_phase: Isotropic) -> AirlightPhase:
    """Return F = 1."""
    return AirlightPhase(None, 1.0, 1.0, 0.0, no_slope)


def ball(_phase: Isotropic, mu: Any, _analytic: bool) -> Any:
    """Return 4 pi f = 1."""
    return mu * 0 + 1


def peak(_phase: Isotropic, _mu: Any) -> int:
    """Return the greatest 4 pi f."""
    return 1
