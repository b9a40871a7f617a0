"""The ground of Minnaert 1941."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.grounds import GroundBeams
from fogproof.scene.grounds.minnaert import MinnaertGround


def brdf(ground: MinnaertGround, light: GroundBeams) -> tuple[np.ndarray, np.ndarray]:
    """Return albedo (k + 1)/(2 pi) (mu0 mu)^(k - 1)."""
    k = ground.exponent
    with np.errstate(under="ignore"):
        shape = (light.mu0 * light.mu) ** (k - 1) + 0 * light.azimuth
        value = ground.albedo * (k + 1) / (2 * np.pi) * shape
        return value, (4 + k) * EPS * value


def absorbed(ground: MinnaertGround, mu: np.ndarray) -> np.ndarray:
    """Return 1 - albedo mu^(k - 1), what is not reflected of a beam at cosines mu (n,)."""
    with np.errstate(under="ignore"):
        return 1 - ground.albedo * mu ** (ground.exponent - 1)
