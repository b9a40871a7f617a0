"""The homogeneous medium."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.double_double import UNIT
from fogproof.analytic.arithmetic.error_free import EPS, TINY, sum_times, two_sum
from fogproof.analytic.geometry.rays import Rays, Thickness, rays_with_channels
from fogproof.analytic.media.coefficients import Coefficients, Points
from fogproof.analytic.proven.balls import rational
from fogproof.analytic.proven.pieces import Piece, constant
from fogproof.contracts import Reference
from fogproof.scene import Medium, Ray

SOURCE = "Bouguer 1729, Beer 1852; Chandrasekhar 1960, Radiative Transfer, section 7"

LINEAR_IN = ("sigma_t", "sigma_a", "sigma_s")
"""What sigma_t is proportional to wherever it stands alone: sums of these with weights >= 0, at the same albedo."""


def coefficients(medium: Medium, at: Points) -> Coefficients:
    """Return what is the same everywhere."""
    return Coefficients(
        medium.sigma_t, np.asarray(medium.sigma_a), np.asarray(medium.sigma_s), np.asarray(medium.emission)
    )


def uniform(medium: Medium) -> tuple[np.ndarray, np.ndarray]:
    """Return sigma_t as the unrounded sum of sigma_a and sigma_s, a pair [1/m], () or (channels,) each."""
    return two_sum(medium.sigma_a, medium.sigma_s)


def shares(medium: Medium) -> tuple[np.ndarray, np.ndarray]:
    """Return sigma_s / sigma_t and sigma_a / sigma_t, both 0 in an empty medium."""
    whole = medium.sigma_t
    return medium.albedo, np.divide(medium.sigma_a, whole, out=np.zeros_like(whole), where=whole > 0)


def thickness(medium: Medium, ray: Ray, channels: int | None) -> Thickness:
    """Return tau = sigma_t s. Error: 2^-100 relative."""
    value, low = sum_times(medium.sigma_a, medium.sigma_s, rays_with_channels(ray, channels).length)
    with np.errstate(under="ignore", invalid="ignore"):
        error = np.where(np.isinf(value), 0.0, UNIT * value + 2 * TINY)
    return Thickness(value, low, error, "tau = sigma_t s, unrounded", SOURCE)


def free_path(medium: Medium, rays: Rays, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return t = tau / sigma_t and its error."""
    sigma = uniform(medium)[0]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore", under="ignore"):
        value = np.where(tau > 0, tau / sigma, 0.0)
    return value, np.where(np.isinf(value), 0.0, (1.5 * EPS + UNIT) * value + TINY)


def emission_per_volume(medium: Medium, ray: Ray) -> Reference:
    """Return q s phi1(tau)."""
    from fogproof.analytic.rays.emission import constant_extinction

    return constant_extinction(medium, ray)


def squared(medium: Medium) -> Medium:
    """Return the medium with the extinction sigma_t^2."""
    sigma = np.asarray(medium.sigma_t) ** 2
    return Medium(float(sigma) if sigma.ndim == 0 else tuple(sigma.tolist()), 0.0)


def pieces(medium: Medium, origin: np.ndarray, direction: np.ndarray, length: object) -> list[Piece]:
    """Return the one piece of the ray."""
    absorbed, scattered = rational(medium.sigma_a), rational(medium.sigma_s)
    sigma = absorbed + scattered
    return [constant(sigma, length, scattered / sigma if sigma else sigma, rational(medium.emission))]
