"""Transmittance: the fraction of radiance that survives a way through the medium (Beer's law)."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import RAY, quantity
from fogproof.analytic.geometry.rays import channels_of
from fogproof.analytic.media.thickness import survival, thickness
from fogproof.analytic.proven.radiance import proven_thickness, proven_transmittance
from fogproof.contracts import Reference
from fogproof.scene import Ray
from fogproof.scene.media import AnyMediumField


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
