"""Parallel light."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fogproof.estimators.airlight.lighting import Illumination
from fogproof.estimators.grey import grey
from fogproof.estimators.kernels.path_data import PARALLEL, Lamp
from fogproof.scene.lights import DirectionalLight
from fogproof.scene.rays import Ray


def illumination(light: DirectionalLight, ray: Ray) -> Callable[[np.ndarray], Illumination]:
    """Return what arrives as a function of the distance from the ray's origin: everywhere the same."""
    mu = -float(np.asarray(light.direction) @ ray.direction)
    irradiance = grey("irradiance", light.irradiance)
    return lambda s: Illumination(np.full_like(s, mu), np.full_like(s, np.inf), np.full_like(s, irradiance))


def towards(light: DirectionalLight, x: np.ndarray) -> np.ndarray:
    """Return unit vectors (3, n) from points x (3, n) to the light."""
    return np.broadcast_to(-np.asarray(light.direction)[:, None], x.shape)


def lamp(light: DirectionalLight) -> Lamp:
    """Return the light for kernels."""
    return Lamp(PARALLEL, *light.direction, grey("irradiance", light.irradiance))
