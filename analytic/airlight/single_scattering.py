"""Airlight along camera rays: radiance that one scattering sends from a light to the camera."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fogproof.analytic.airlight.by_quadrature import single_scattering_by_quadrature
from fogproof.analytic.airlight.integral import Method
from fogproof.analytic.airlight.result import Result
from fogproof.analytic.declaration import FOG, FORWARD, LAMP, RADIANCE, RAY, quantity
from fogproof.analytic.geometry.flat_rays import FlatRays, blocks_of
from fogproof.analytic.media.coefficients import is_uniform
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.kinds import given
from fogproof.scene.lights import Light, LightField, strength
from fogproof.scene.media import AnyMediumField
from fogproof.scene.occluders import Occluder, OccluderField
from fogproof.scene.shapes import EVERYWHERE, Shape, ShapeField
from fogproof.validate import channel_count


@quantity(
    unit=RADIANCE,
    convention="airlight alone, without the background; the light's intensity is in W/sr; " + FORWARD,
    source="Sun, Ramamoorthi, Narasimhan & Nayar 2005, A practical analytic single scattering model",
    example={"medium": {**FOG, "phase": {"kind": "henyey-greenstein", "g": 0.6}}, "ray": RAY, "light": LAMP},
)
def single_scattering(
    medium: AnyMediumField,
    ray: Ray,
    light: LightField,
    *,
    occluders: Sequence[OccluderField] = (),
    shape: ShapeField | None = None,
    method: Method = "asinh",
    exact: bool = False,
) -> Reference:
    """Return the single-scattered radiance (airlight) along camera rays [W/(m^2 sr)].

    L = int_0^length T(camera, x_t) sigma_s(x_t) int f_p(x_t, mu) L_light(x_t, w) T dw dt; for a point light of intensity I
    [W/sr] at distance r the inner integral is f_p(mu) I T(x_t, light)/r^2.

    medium     homogeneous, or any other kind for lights with a position or a direction
    ray        rays of shape R
    light      point, spot or directional light, or a constant environment
    occluders  spheres and disks between the light and the ray; the camera sees past them
    shape      convex region that a homogeneous medium fills; all of space unless given. From outside of all of space no
               light arrives: a directional light and an environment give 0 there
    method     how the airlight integral of a homogeneous medium is computed, see `airlight_integral`

    exact      take the coordinates as they stand, and not as rounded by up to half a unit in the last place

    The result has shape R, or R + (C,) if medium or light have C channels. A light on the ray gives inf, a medium that
    does not scatter 0. For homogeneous media `error` is a bound. It counts rounding, and unless `exact` half a unit in the last
    place of each coordinate of the origin, the direction and the light: a direction in float64 is no better than that, and
    neither is the answer for a light close to the ray. For other media, environments, light with extent and shapes without the
    light in them it is an estimate by quadrature.
    Source: Sun, Ramamoorthi, Narasimhan & Nayar 2005, A practical analytic single scattering model (homogeneous, point).
    """
    shape = EVERYWHERE if shape is None else shape
    for name, thing, kinds in (("medium", medium, AnyMedium), ("light", light, Light), ("shape", shape, Shape)):
        if not isinstance(thing, kinds):
            raise InvalidValueError(name, f"must be a {name}", thing)
    if not isinstance(ray, Ray):
        raise InvalidValueError("ray", "must be a Ray", ray)
    for occluder in occluders:
        if not isinstance(occluder, Occluder):
            raise InvalidValueError("occluders", "must be a list of Sphere and Disk", occluder)
    if not is_uniform(medium) and shape != EVERYWHERE:
        raise UnsupportedError(f"a {type(medium).__name__} has bounds of its own: leave the shape away", "shape")
    medium_channels = (0.0,) * medium.channels if medium.channels else 0.0
    channels = channel_count(medium=medium_channels, light=strength(light))
    parts = [_along(medium, block, light, shape, occluders, method, exact) for block in blocks_of(ray)]
    value, error = (np.concatenate(columns) for columns in list(zip(*parts, strict=True))[:2])
    result = ray.shape if channels is None else (*ray.shape, channels)
    value, error = (np.broadcast_to(x, (*x.shape[:-1], channels or 1)).reshape(result) for x in (value, error))
    return Reference(value, error, *parts[0][2:])


def _along(
    medium: AnyMedium,
    ray: FlatRays,
    light: Light,
    shape: Shape,
    occluders: Sequence[Occluder],
    method: Method,
    exact: bool,
) -> Result:
    """Return radiance and error (n, channels) of rays of shape (n,), method and source: in closed form, or by quadrature."""
    if light.distant and shape == EVERYWHERE and is_uniform(medium):
        zero = np.zeros((len(ray.length), medium.channels or 1))
        return zero, zero, "no light arrives from infinitely far", "Beer's law"
    known = given(light, "fogproof.analytic.lights", "single_scattering")
    found: Result | None = known and known(
        medium, ray, light, shape=shape, occluders=occluders, method=method, exact=exact
    )
    return found or single_scattering_by_quadrature(medium, ray, light, shape, occluders, exact)
