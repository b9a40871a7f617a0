"""The inverse of the optical thickness: how far one gets until it reaches a given value."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.declaration import RAY, quantity
from fogproof.analytic.geometry.rays import channels_of, rays_with_channels
from fogproof.analytic.media.coefficients import ROOM
from fogproof.analytic.rays.bracketed_free_path import bracketed_free_path
from fogproof.contracts import Reference
from fogproof.scene import Ray
from fogproof.scene.arrays import FloatArray
from fogproof.scene.kinds import given
from fogproof.scene.media import AnyMediumField
from fogproof.validate import as_float_array, require


@quantity(
    unit="m",
    convention="distance at which the optical thickness is tau; inf where the ray ends or escapes before",
    source="elementary: the optical thickness inverted",
    example={
        "medium": {"kind": "exponential", "sigma_0": 0.3, "rate": [0, 0, -0.5], "albedo": 0.9},
        "ray": {**RAY, "length": "inf"},
        "tau": [0.01, 0.1, 100],
    },
)
def free_path(medium: AnyMediumField, ray: Ray, tau: FloatArray) -> Reference:
    """Return the smallest distance t [m] at which the optical thickness reaches tau, inf if the ray ends before.

    medium  of any kind; homogeneous, linear and exponential ones have a closed form, for the others the thickness is
            enclosed from both sides
    tau     (...) >= 0, broadcast against the rays; tau = -log1p(-xi) makes it the inverse of the free-path
            distribution for a uniform xi

    The shape is that of the rays and tau together, then (channels,). A transition from "reaches" to "escapes" within
    the uncertainty of the inputs' dot products has error inf.
    Error: about 8 EPS times the condition number, which grows where the medium thins out.
    Source: elementary; t = 2 tau/(a + sqrt(a^2 + 2 b tau)) and t = (tau/sigma) log1p(k tau/sigma)/(k tau/sigma).
    """
    channels = channels_of(medium)
    rays_with_channels(ray, None)  # refuses what is no ray
    tau = as_float_array("tau", tau)
    require("tau", tau, (tau >= 0) & np.isfinite(tau), "must be finite and >= 0")
    shape = np.broadcast_shapes(ray.shape, tau.shape)
    wide = Ray(np.broadcast_to(ray.origin, (*shape, 3)), np.broadcast_to(ray.direction, (*shape, 3)), ray.length)
    rays = rays_with_channels(wide, channels)
    wanted = tau if channels is None else tau[..., None]
    own = given(medium, ROOM, "free_path")
    if own is None:
        return bracketed_free_path(medium, wide, tau, channels)
    value, error = own(medium, rays, wanted)
    value, error = np.broadcast_to(value, rays.shape), np.broadcast_to(error, rays.shape)
    with np.errstate(invalid="ignore"):
        close = (np.abs(value - rays.length) <= error) & np.isfinite(rays.length)
        close &= wanted > 0  # no ray is too short for nothing
    value = np.where(value > rays.length, np.inf, value)
    return Reference(value, np.where(close, np.inf, error), "closed form", "elementary")
