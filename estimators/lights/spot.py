"""The spot light."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fogproof.estimators.airlight.lighting import Illumination, at_a_point, to_a_point
from fogproof.estimators.grey import grey
from fogproof.scene.lights import SpotLight
from fogproof.scene.rays import Ray


def illumination(light: SpotLight, ray: Ray) -> Callable[[np.ndarray], Illumination]:
    """Return what arrives as a function of the distance from the ray's origin."""
    return lambda s: _in_the_cone(light, ray, s)


def towards(light: SpotLight, x: np.ndarray) -> np.ndarray:
    """Return unit vectors (3, n) from points x (3, n) to the light."""
    return to_a_point(light.position, x)


def focus(light: SpotLight) -> tuple[float, float, float]:
    """Return where it is."""
    return light.position


def _in_the_cone(light: SpotLight, ray: Ray, s: np.ndarray) -> Illumination:
    """The cone is cut and its edge softened by the cosine of the angle from its axis, linear in s but for 1/r."""
    mu, r, irradiance = at_a_point(light.position, grey("intensity", light.intensity), ray, s)
    axis = np.asarray(light.direction)
    cosine = (float(axis @ (ray.origin - np.asarray(light.position))) + s * float(axis @ ray.direction)) / r
    edge = float(np.cos(light.half_angle))
    full = edge if light.falloff_start is None else float(np.cos(light.falloff_start))
    share = (cosine >= edge).astype(s.dtype)
    if light.profile == "linear" and light.falloff_start is not None and light.falloff_start < light.half_angle:
        angle = np.arccos(np.clip(cosine, -1, 1))
        share *= np.clip((light.half_angle - angle) / (light.half_angle - light.falloff_start), 0, 1)
    elif full > edge:
        rise = np.clip((cosine - edge) / (full - edge), 0, 1)
        share *= rise * rise * (3 - 2 * rise)
    if light.exponent:
        share *= np.maximum(cosine, 0) ** light.exponent
    return Illumination(mu, r, irradiance * share)
