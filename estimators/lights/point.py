"""The point light."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fogproof.estimators.airlight.lighting import Illumination, at_a_point, to_a_point
from fogproof.estimators.grey import grey
from fogproof.estimators.kernels.path_data import POINT, Lamp
from fogproof.scene.lights import PointLight
from fogproof.scene.rays import Ray


def illumination(light: PointLight, ray: Ray) -> Callable[[np.ndarray], Illumination]:
    """Return what arrives as a function of the distance from the ray's origin."""
    return lambda s: at_a_point(light.position, grey("intensity", light.intensity), ray, s)


def towards(light: PointLight, x: np.ndarray) -> np.ndarray:
    """Return unit vectors (3, n) from points x (3, n) to the light."""
    return to_a_point(light.position, x)


def focus(light: PointLight) -> tuple[float, float, float]:
    """Return where it is."""
    return light.position


def lamp(light: PointLight) -> Lamp:
    """Return the light for kernels."""
    return Lamp(POINT, *light.position, grey("intensity", light.intensity))
