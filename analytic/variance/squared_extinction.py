"""The integral of sigma_t^2 along rays, which is what the variance of ratio tracking knows of a medium.

Where the square of an extinction is an extinction of the same kind (homogeneous, exponential, layers, nearest voxels,
the user's own function) it is the optical thickness of that medium. Along a ray through a linear medium, trilinear
voxels or OpenGL's fog sigma_t is a polynomial between known breaks, and one Gauss-Legendre panel is exact.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.arithmetic.panel_rule import NODES, WEIGHTS
from fogproof.analytic.geometry.rays import rays_with_channels
from fogproof.analytic.media.breakpoints import breakpoints
from fogproof.analytic.media.coefficients import coefficients
from fogproof.analytic.rays.transmittance import thickness
from fogproof.scene import (
    AnisotropicMedium,
    AnyMedium,
    ExponentialMedium,
    Medium,
    OpenGLFog,
    PiecewiseConstantMedium,
    Procedural,
    Ray,
    VoxelGrid,
)


class Integral(NamedTuple):
    """An integral along each ray in the full shape of the result, its error, and how it was found."""

    value: np.ndarray
    error: np.ndarray
    method: str


def squared_extinction(medium: AnyMedium, ray: Ray, channels: int | None) -> Integral:
    """Return int sigma_t^2 dt along the rays [1/m], with that many channels.

    Error: a few EPS relative, plus what rounded positions mean; estimated for a user's function.
    """
    if isinstance(medium, AnisotropicMedium):
        unit = thickness(medium, Ray(ray.origin, ray.direction, np.ones(())), channels)
        length = rays_with_channels(ray, channels).length
        with np.errstate(invalid="ignore", over="ignore"):
            value = np.where(unit.value > 0, unit.value**2 * length, 0.0)
            error = np.where(np.isfinite(value), value * 6 * EPS + 3 * unit.value * unit.error * length, 0.0)
        return Integral(value, error + TINY, "constant along the ray")
    squared = _squared(medium)
    if squared is None:
        return _by_panels(medium, ray, channels)
    tau = thickness(squared, ray, channels)
    with np.errstate(invalid="ignore"):
        error = np.where(np.isfinite(tau.value), tau.error + 4 * EPS * tau.value, 0.0)
    return Integral(tau.value, error + TINY, f"thickness of the squared medium: {tau.method}")


def _squared(medium: AnyMedium) -> Any:
    """Return the medium with extinction sigma_t^2, or None if it is of another kind."""
    match medium:
        case Medium():
            return Medium(_square(medium.sigma_t), 0.0)
        case ExponentialMedium():
            return ExponentialMedium(_square(np.asarray(medium.sigma_0)), 2 * medium.rate)
        case PiecewiseConstantMedium():
            return replace(medium, sigma_t=medium.sigma_t**2)
        case VoxelGrid() if medium.interpolation == "nearest":
            return replace(medium, sigma_t=medium.sigma_t**2)
        case Procedural():
            return replace(
                medium,
                sigma_t=lambda *x: np.square(medium.sigma_t(*x)),
                majorant=medium.majorant**2,
                albedo=0.0,
                emission=0.0,
            )
    return None


def _square(sigma: np.ndarray) -> Any:
    return float(sigma**2) if sigma.ndim == 0 else tuple((sigma**2).tolist())


def _by_panels(medium: AnyMedium, ray: Ray, channels: int | None) -> Integral:
    """Return the integral over panels between breaks, where sigma_t is a polynomial of degree 3 at most.

    A rounded position moves sigma_t by at most what it changes between neighbouring nodes; see `adaptive`.
    """
    if isinstance(medium, OpenGLFog) and medium.mode == "linear":
        return _linear_fog(medium, ray, channels)
    edges = breakpoints(medium, ray)
    width = np.diff(edges, axis=-1)[..., None]
    t = edges[:, :-1, None] + width * NODES
    origin, w = ray.origin.reshape(-1, 1, 1, 3), ray.direction.reshape(-1, 1, 1, 3)
    sigma = coefficients(medium, origin + t[..., None] * w, w, channels).sigma_t
    if channels is not None:
        width, t = width[..., None], t[..., None]
    weights = WEIGHTS if channels is None else WEIGHTS[:, None]
    terms = width * weights * sigma**2
    place = 4 * EPS * (np.abs(origin).max() + np.abs(t).max(initial=0.0))
    axes = (1, 2)
    moved = np.abs(np.diff(np.square(sigma), axis=2)).sum(axis=axes) + np.square(sigma).max(axis=axes, initial=0.0)
    shape = ray.shape if channels is None else (*ray.shape, channels)
    value = terms.sum(axis=axes)
    error = 16 * EPS * value + 2 * place * moved + TINY
    return Integral(value.reshape(shape), error.reshape(shape), "Gauss-Legendre 16 between breaks, exact")


def _linear_fog(medium: OpenGLFog, ray: Ray, channels: int | None) -> Integral:
    """Return int (end - t)^-2 dt = 1/(end - s) - 1/(end - start), inf where the ray reaches the end of the fog."""
    span = medium.end - medium.start
    inside = np.clip(rays_with_channels(ray, channels).length - medium.start, 0.0, span)
    shape = ray.shape if channels is None else (*ray.shape, channels)
    with np.errstate(divide="ignore", invalid="ignore"):
        value = np.where(inside > 0, inside / (span * (span - inside)), 0.0)
        slack = EPS * medium.end * (1 / span + 1 / (span - inside)) + 4 * EPS
        error = np.where(np.isfinite(value), 3 * slack * value + TINY, 0.0)
    return Integral(np.broadcast_to(value, shape), np.broadcast_to(error, shape), "closed form")
