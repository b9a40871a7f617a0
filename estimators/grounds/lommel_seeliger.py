"""The ground of Lommel and Seeliger: directions of the grains' phase function; those that lead down end."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.phase.functions import phase_value, polar
from fogproof.scene.grounds.lommel_seeliger import LommelSeeligerGround

Bounce = tuple[np.ndarray, np.ndarray, np.ndarray]


def reflect(ground: LommelSeeligerGround, mu0: np.ndarray, u: np.ndarray) -> Bounce:
    """Return cosines, azimuths and weights."""
    turn = polar(ground.phase, u[:, 0])
    cosine = (turn.coversine - turn.versine) / 2
    sine = np.sqrt(turn.versine * turn.coversine)
    about = 2 * np.pi * u[:, 1]
    down = np.sqrt(1 - mu0 * mu0)  # the way down is (down, 0, -mu0); (mu0, 0, down) and (0, 1, 0) stand across it
    mu = sine * np.cos(about) * down - cosine * mu0
    azimuth = np.arctan2(sine * np.sin(about), sine * np.cos(about) * mu0 + cosine * down)
    up = mu > 0
    mu = np.where(up, mu, 1.0)
    return mu, azimuth, np.where(up, ground.albedo * mu / (mu0 + mu), 0.0)


def value(ground: LommelSeeligerGround, mu0: np.ndarray, mu: float, azimuth: np.ndarray) -> np.ndarray:
    """Return the BRDF [1/sr]."""
    cosine = np.sqrt((1 - mu0 * mu0) * (1 - mu * mu)) * np.cos(azimuth) - mu0 * mu
    return ground.albedo * phase_value(ground.phase, np.clip(cosine, -1, 1)) / (mu0 + mu)
