"""The ground that reflects equally into all directions: cosines with density 2 mu."""

from __future__ import annotations

import numpy as np

from fogproof.scene.grounds.lambert import LambertGround

Bounce = tuple[np.ndarray, np.ndarray, np.ndarray]


def reflect(ground: LambertGround, mu0: np.ndarray, u: np.ndarray) -> Bounce:
    """Return cosines, azimuths and weights."""
    return np.sqrt(1 - u[:, 0]), 2 * np.pi * u[:, 1], np.full(len(u), ground.albedo)


def value(ground: LambertGround, mu0: np.ndarray, mu: float, azimuth: np.ndarray) -> np.ndarray:
    """Return the BRDF [1/sr]."""
    return np.full(len(mu0), ground.albedo / np.pi)
