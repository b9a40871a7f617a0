"""What a light sends to the points of a ray: from which cosine, from how far, and how much before the medium takes its share."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.grey import grey
from fogproof.scene import Ray
from fogproof.scene.lights import DirectionalLight, Light, PointLight, SpotLight


class Illumination(NamedTuple):
    """At points of a ray, each (n,).

    mu          forward cosine of the scattering towards the camera
    distance    of the light [m]; inf for parallel light
    irradiance  on a plane normal to the light, in vacuum [W/m^2]
    """

    mu: np.ndarray
    distance: np.ndarray
    irradiance: np.ndarray


def foot(ray: Ray, position: tuple[float, float, float]) -> tuple[float, float]:
    """Return the distance h of a point from the ray's line [m], and the distance from the ray's origin to the foot of it."""
    towards = np.asarray(position) - ray.origin
    along = float(towards @ ray.direction)
    return float(np.linalg.norm(towards - along * ray.direction)), along


def illumination(light: Light, ray: Ray) -> Callable[[np.ndarray], Illumination]:
    """Return the function of the distance s (n,) [m] from the ray's origin.

    For a light at a point all is told by t, counted from the foot: r^2 = h^2 + t^2 and mu = -t/r.
    """
    match light:
        case PointLight():
            return lambda s: _point(light.position, grey("intensity", light.intensity), ray, s)
        case SpotLight():
            return lambda s: _spot(light, ray, s)
        case DirectionalLight():
            mu = -float(np.asarray(light.direction) @ ray.direction)
            irradiance = grey("irradiance", light.irradiance)
            return lambda s: Illumination(np.full_like(s, mu), np.full_like(s, np.inf), np.full_like(s, irradiance))
    raise UnsupportedError(f"a {type(light).__name__} shines from everywhere: use EnvironmentAirlight", "light")


def towards(light: PointLight | SpotLight | DirectionalLight, x: np.ndarray) -> np.ndarray:
    """Return unit vectors (3, n) from points x (3, n) to the light."""
    if isinstance(light, DirectionalLight):
        return np.broadcast_to(-np.asarray(light.direction)[:, None], x.shape)
    w = np.asarray(light.position)[:, None] - x
    return w / np.sqrt(np.sum(w * w, axis=0))


def _point(position: tuple[float, float, float], intensity: float, ray: Ray, s: np.ndarray) -> Illumination:
    h, along = foot(ray, position)
    t = s - along
    r2 = h * h + t * t
    r = np.sqrt(r2)
    return Illumination(-t / r, r, intensity / r2)


def _spot(light: SpotLight, ray: Ray, s: np.ndarray) -> Illumination:
    """The cone is cut and its edge softened by the cosine of the angle from its axis, linear in s but for 1/r."""
    mu, r, irradiance = _point(light.position, grey("intensity", light.intensity), ray, s)
    axis = np.asarray(light.direction)
    cosine = (float(axis @ (ray.origin - np.asarray(light.position))) + s * float(axis @ ray.direction)) / r
    edge = float(np.cos(light.half_angle))
    full = edge if light.falloff_start is None else float(np.cos(light.falloff_start))
    share = (cosine >= edge).astype(s.dtype)
    if full > edge:
        rise = np.clip((cosine - edge) / (full - edge), 0, 1)
        share *= rise * rise * (3 - 2 * rise)
    if light.exponent:
        share *= np.maximum(cosine, 0) ** light.exponent
    return Illumination(mu, r, irradiance * share)
