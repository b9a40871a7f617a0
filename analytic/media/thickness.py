"""Optical thickness and transmittance of any medium: its own closed form, or quadrature."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import ELEMENTARY, TINY, exp_minus
from fogproof.analytic.geometry.rays import Thickness, rays_with_channels
from fogproof.analytic.media.adaptive import thickness_by_quadrature
from fogproof.analytic.media.coefficients import ROOM
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.kinds import given


def thickness(medium: AnyMedium, ray: Ray, channels: int | None) -> Thickness:
    """Return tau in the full shape of a result with that many channels."""
    shape = rays_with_channels(ray, channels).shape
    tau = (given(medium, ROOM, "thickness") or thickness_by_quadrature)(medium, ray, channels)

    def shaped(x: np.ndarray) -> np.ndarray:
        return np.broadcast_to(x if x.ndim == len(shape) else x[..., None], shape)

    return Thickness(shaped(tau.value), shaped(tau.low), shaped(tau.error), tau.method, tau.source)


def survival(tau: Thickness) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return exp(-tau), the bound of its rounding error, and of the error it inherits from tau."""
    value, rounding = exp_minus(tau.value, tau.low)
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        inherited = np.where(tau.error > 0, (value + 2 * TINY) * np.expm1(tau.error), 0.0)
        at_most = np.exp(-np.maximum(tau.value - tau.error, 0.0)) * (1 + ELEMENTARY) + 2 * TINY
    return value, rounding, np.fmin(inherited, at_most)
