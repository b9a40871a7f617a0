"""The ground that reflects equally into all directions."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.grounds import GroundBeams
from fogproof.scene.grounds.lambert import LambertGround


def brdf(ground: LambertGround, light: GroundBeams) -> tuple[np.ndarray, np.ndarray]:
    """Return albedo/pi."""
    value = np.full(np.broadcast_shapes(*(x.shape for x in light)), ground.albedo / np.pi)
    return value, EPS * value


def absorbed(ground: LambertGround, mu: np.ndarray) -> np.ndarray:
    """Return 1 - albedo, the same at every cosine (n,)."""
    return np.full_like(mu, 1 - ground.albedo)
