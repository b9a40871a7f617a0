"""Transmittance: the fraction of radiance that survives a way through the medium (Beer's law)."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.double_double import UNIT
from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY, exp_minus, sum_times
from fogproof.analytic.declaration import RAY, quantity
from fogproof.analytic.geometry.rays import Rays, Thickness, channels_of, rays_with_channels
from fogproof.analytic.media.adaptive import procedural_thickness
from fogproof.analytic.media.anisotropic import anisotropic_thickness
from fogproof.analytic.media.cells import cell_thickness
from fogproof.analytic.media.exponential import exponential_thickness
from fogproof.analytic.media.linear import linear_thickness
from fogproof.analytic.media.opengl_fog import fog_thickness
from fogproof.analytic.proven.radiance import proven_thickness, proven_transmittance
from fogproof.contracts import Reference
from fogproof.scene import (
    AnisotropicMedium,
    AnyMedium,
    ExponentialMedium,
    LinearMedium,
    Medium,
    OpenGLFog,
    Procedural,
    Ray,
)
from fogproof.scene.media import AnyMediumField

SOURCE = "Bouguer 1729, Beer 1852; Chandrasekhar 1960, Radiative Transfer, section 7"


@quantity(
    unit="1",
    convention="integral of sigma_t along the ray",
    source="Bouguer 1729; Lambert 1760",
    example={"medium": {"kind": "exponential", "sigma_0": 0.3, "rate": [0, 0, -0.5], "albedo": 0.9}, "ray": RAY},
)
def optical_thickness(medium: AnyMediumField, ray: Ray, *, rigorous: bool = False) -> Reference:
    """Return tau = integral of sigma_t along the ray, dimensionless, shape R or R + (channels,).

    rigorous  prove the result by ball arithmetic (any medium but a `Procedural` one; slow)

    Positions are origin + t direction, with the direction as stored; in heterogeneous media components of directions
    and gradients below 1e-100 count as 0. An empty medium has tau = 0 on every ray, the infinite one included.
    Error: 1 EPS relative for a homogeneous medium; see the method named in the result for the others.
    """
    if rigorous:
        return proven_thickness(medium, ray).reference()
    tau = thickness(medium, ray, channels_of(medium))
    with np.errstate(under="ignore", invalid="ignore"):
        value = tau.value + tau.low
        return Reference(value, tau.error + np.where(np.isinf(value), 0.0, EPS * value + TINY), tau.method, tau.source)


@quantity(
    unit="1",
    convention="fraction of the radiance that arrives: exp(-optical thickness)",
    source="Bouguer 1729; Lambert 1760",
    example={"medium": {"kind": "exponential", "sigma_0": 0.3, "rate": [0, 0, -0.5], "albedo": 0.9}, "ray": RAY},
)
def transmittance(medium: AnyMediumField, ray: Ray, *, rigorous: bool = False) -> Reference:
    """Return T = exp(-tau), dimensionless, shape R or R + (channels,).

    rigorous  prove the result by ball arithmetic (any medium but a `Procedural` one; slow)

    Error: at most 6 EPS relative for every tau where tau is known as a pair (homogeneous, linear, layers, nearest
    voxels), because it is never rounded; else the error of tau more. Where T underflows it is absolute, 2 TINY.
    """
    if rigorous:
        return proven_transmittance(medium, ray).reference()
    tau = thickness(medium, ray, channels_of(medium))
    value, rounding, inherited = survival(tau)
    return Reference(value, rounding + inherited, f"exp(-tau), {tau.method}", tau.source)


def survival(tau: Thickness) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return exp(-tau), the bound of its rounding error, and of the error it inherits from tau."""
    value, rounding = exp_minus(tau.value, tau.low)
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        inherited = np.where(tau.error > 0, (value + 2 * TINY) * np.expm1(tau.error), 0.0)
        at_most = np.exp(-np.maximum(tau.value - tau.error, 0.0)) * (1 + ELEMENTARY) + 2 * TINY
    return value, rounding, np.fmin(inherited, at_most)


def thickness(medium: AnyMedium, ray: Ray, channels: int | None) -> Thickness:
    """Return tau in the full shape of a result with that many channels."""
    rays = rays_with_channels(ray, channels)
    match medium:
        case Medium():
            tau = _homogeneous(medium, rays)
        case LinearMedium():
            tau = linear_thickness(medium, rays)
        case ExponentialMedium():
            tau = exponential_thickness(medium, rays)
        case AnisotropicMedium():
            tau = anisotropic_thickness(medium, rays)
        case OpenGLFog():
            tau = fog_thickness(medium, rays)
        case Procedural():
            tau = procedural_thickness(medium, ray)
        case _:
            tau = cell_thickness(medium, ray)

    def shaped(x: np.ndarray) -> np.ndarray:
        return np.broadcast_to(x if x.ndim == len(rays.shape) else x[..., None], rays.shape)

    return Thickness(shaped(tau.value), shaped(tau.low), shaped(tau.error), tau.method, tau.source)


def _homogeneous(medium: Medium, rays: Rays) -> Thickness:
    value, low = sum_times(medium.sigma_a, medium.sigma_s, rays.length)
    with np.errstate(under="ignore", invalid="ignore"):
        error = np.where(np.isinf(value), 0.0, UNIT * value + 2 * TINY)
    return Thickness(value, low, error, "tau = sigma_t s, unrounded", SOURCE)
