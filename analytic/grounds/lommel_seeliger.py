"""The ground of Lommel and Seeliger: what a half space scatters once."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.geometry.turning import turning
from fogproof.analytic.grounds import GroundBeams
from fogproof.analytic.phase.functions import phase_values
from fogproof.scene.grounds.lommel_seeliger import LommelSeeligerGround


def brdf(ground: LommelSeeligerGround, light: GroundBeams) -> tuple[np.ndarray, np.ndarray]:
    """Return albedo f_p/(mu0 + mu) at the angle by which light is turned."""
    x, y = turning(light.mu0, light.mu, light.azimuth, turns_back=True)
    shape = x.shape
    density, error = phase_values(ground.phase, np.clip(y - x, -1, 1).ravel(), x.ravel(), y.ravel())
    share = ground.albedo / (light.mu0 + light.mu)
    value = share * density.reshape(shape)
    return value, share * error.reshape(shape) + 8 * EPS * value
