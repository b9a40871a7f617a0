"""Exact variance of one-sample estimates of single scattering from a point light."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.airlight.phase import airlight_phase
from fogproof.analytic.airlight.ray_and_light import place
from fogproof.analytic.airlight.single_scattering import single_scattering
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import FOG, LAMP, RAY, quantity
from fogproof.analytic.media.coefficients import is_uniform
from fogproof.analytic.variance.airlight import Sampling, airlight_second_moment
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import PointLight, Ray
from fogproof.scene.lights import LightField
from fogproof.scene.media import AnyMediumField
from fogproof.validate import channel_count

NOTHING = 2000.0
"""Mean free paths that leave less than 1e-860, which no 1/r^4 and no intensity that is a float64 lifts to one."""


@quantity(
    unit="(W/(m^2 sr))^2",
    convention="mean square of one realisation that places its scattering event by `sampling`",
    source="Kulla & Fajardo 2012, Importance sampling techniques for path tracing in participating media",
    example={"medium": FOG, "ray": RAY, "light": LAMP, "sampling": "equiangular"},
)
def single_scattering_second_moment(
    medium: AnyMediumField, ray: Ray, light: LightField, sampling: Sampling
) -> Reference:
    """Return E[X^2] of an estimate X of `single_scattering` [(W/(m^2 sr))^2], shape R or R + (channels,).

    medium    homogeneous
    ray       rays of shape R; nothing stands between their points and the light
    light     a point light
    sampling  how X places its one scattering event: "equiangular", "free-path" (and 0 if the path misses the ray's
              length), "distance" (a free path that ends on the ray) or "uniform"

    A light on the ray gives inf, a medium that does not scatter 0. `error` counts rounding and half a unit in the last
    place of each coordinate, as for `single_scattering`.
    Source: Kulla & Fajardo 2012, Importance sampling techniques for path tracing in participating media (equiangular).
    """
    if not is_uniform(medium):
        raise UnsupportedError(f"single scattering needs a homogeneous Medium, got {type(medium).__name__}", "medium")
    if not isinstance(light, PointLight):
        raise UnsupportedError(f"single scattering needs a PointLight, got {type(light).__name__}", "light")
    channels = channel_count(sigma_a=medium.sigma_a, sigma_s=medium.sigma_s, intensity=light.intensity)
    shape = ray.shape if channels is None else (*ray.shape, channels)
    sigma = np.atleast_1d(medium.sigma_t)
    scale = np.atleast_1d(np.multiply(medium.sigma_s, light.intensity)) / (4 * np.pi)
    where = place(ray, light.position)
    h, a, b, uncertainty = (x[:, None] for x in (where.h, where.a, where.b, where.uncertainty))
    moment = airlight_second_moment(sigma, h, a, b, medium.phase, sampling)
    with np.errstate(all="ignore"):
        # Move the light by d: the two paths change by d each, 1/r^4 by (1 - d/r)^-4, angles by d/r.
        start, end = np.hypot(a, h), np.hypot(b, h)
        turn = uncertainty / np.where(a > 0, start, np.where(b < 0, end, h))
        phase = airlight_phase(medium.phase)
        bend, steep = (x * turn for x in phase.slope(np.where(b < np.inf, -b / end, -1.0), -a / start))
        if phase.floor > 0:
            bend = bend + steep / phase.floor
        elif steep.any():
            bend = np.where(steep > 0, np.inf, bend)
        relative = np.expm1(4 * sigma * uncertainty - 4 * np.log1p(-turn) + 2 * bend / (1 - bend))
        relative = np.where((turn < 1) & (bend < 1), relative, np.inf)
        value = np.where(scale > 0, moment.value * scale * scale, 0.0)
        # All light comes at least as far as the camera is from the lamp. Beyond NOTHING mean free paths none is left, wherever
        # in its last digit the lamp stands; nearer, a value of 0 with a lamp that may stand anywhere says nothing.
        dark = sigma * (start - 4 * uncertainty) > NOTHING
        inherited = np.where(
            moment.value > 0,
            moment.value * (relative + 6 * EPS),
            np.where(np.isfinite(relative) | dark, 0.0, np.inf),
        )
        error = (moment.error + inherited) * scale * scale + TINY
        error = np.where((scale > 0) & np.isfinite(value), error, 0.0)
    return Reference(value.reshape(shape), error.reshape(shape), moment.method, moment.source)


@quantity(
    unit="(W/(m^2 sr))^2",
    convention="variance of one realisation that places its scattering event by `sampling`",
    source="Kulla & Fajardo 2012, Importance sampling techniques for path tracing in participating media",
    example={"medium": FOG, "ray": RAY, "light": LAMP, "sampling": "equiangular"},
)
def single_scattering_variance(medium: AnyMediumField, ray: Ray, light: LightField, sampling: Sampling) -> Reference:
    """Return Var[X] = E[X^2] - L^2 of an estimate X of `single_scattering` [(W/(m^2 sr))^2].

    Arguments, shape and limits as for `single_scattering_second_moment`. The error is absolute: a sampler that is
    nearly perfect leaves a variance that is mostly rounding, never below 0.
    """
    second = single_scattering_second_moment(medium, ray, light, sampling)
    mean = single_scattering(medium, ray, light)
    with np.errstate(all="ignore"):
        finite = np.isfinite(second.value)
        value = np.where(finite, np.maximum(second.value - mean.value**2, 0.0), np.inf)
        error = second.error + (2 * mean.value + mean.error) * mean.error + 2 * EPS * second.value
        error = np.where(finite, error, 0.0)
    return Reference(value, error, f"{second.method}; minus L^2", second.source)
