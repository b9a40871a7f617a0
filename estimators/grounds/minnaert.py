"""The ground of Minnaert 1941: cosines with density (k + 1) mu^k."""

from __future__ import annotations

import numpy as np

from fogproof.scene.grounds.minnaert import MinnaertGround

Bounce = tuple[np.ndarray, np.ndarray, np.ndarray]


def reflect(ground: MinnaertGround, mu0: np.ndarray, u: np.ndarray) -> Bounce:
    """Return cosines, azimuths and weights."""
    k = ground.exponent
    return (1 - u[:, 0]) ** (1 / (k + 1)), 2 * np.pi * u[:, 1], ground.albedo * mu0 ** (k - 1)


def value(ground: MinnaertGround, mu0: np.ndarray, mu: float, azimuth: np.ndarray) -> np.ndarray:
    """Return the BRDF [1/sr]."""
    k = ground.exponent
    return ground.albedo * (k + 1) * (mu0 * mu) ** (k - 1) / (2 * np.pi)
