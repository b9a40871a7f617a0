"""Rayleigh 1871: f(mu) = 3/(16 pi) (1 + mu^2), for unpolarised light and particles much smaller than the wavelength."""

from __future__ import annotations

import numpy as np

from fogproof.scene.phase_functions import Rayleigh

SOURCE = "Rayleigh 1871, Phil. Mag. 41, 107"
EPS = np.finfo(np.float64).eps


def pdf(_phase: Rayleigh, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]; relative error 3 eps."""
    value = 3 / (16 * np.pi) * (1 + mu * mu)
    return value, 3 * EPS * value


def cdf(_phase: Rayleigh, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu) = (4 + 3 mu + mu^3)/8, factored as (1 + mu)(4 - mu (1 - mu))/8; relative error 2 eps."""
    value = (1 + mu) * (4 - mu * (1 - mu)) / 8
    return value, 2 * EPS * value
