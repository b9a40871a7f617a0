"""The sphere that shines: directions uniform in the cone that it fills."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.airlight.around import around
from fogproof.estimators.airlight.lighting import Sampled
from fogproof.estimators.grey import grey
from fogproof.scene.lights import SphereLight


def sample(light: SphereLight, x: np.ndarray, u: np.ndarray) -> Sampled:
    """Return directions uniform in the cone from points x (3, n), from uniforms u (n, 2); from inside there is no light."""
    out = np.asarray(light.center)[:, None] - x
    square = np.sum(out * out, axis=0)
    distance, R2 = np.sqrt(square), light.radius * light.radius
    sine2 = np.minimum(R2 / square, 1.0)
    versine = sine2 / (1 + np.sqrt(1 - sine2)) * u[:, 0]  # 1 - cos, without cancellation for a small sphere
    cosine = 1 - versine
    w = around(out / distance, versine, 2 * np.pi * u[:, 1])
    half2 = np.maximum(R2 - square * versine * (1 + cosine), 0.0)
    way = distance * cosine - np.sqrt(half2)
    solid = 2 * np.pi * sine2 / (1 + np.sqrt(1 - sine2))
    return Sampled(w, np.maximum(way, 0.0), grey("radiance", light.radiance) * np.where(square > R2, solid, 0.0))


def focus(light: SphereLight) -> tuple[float, float, float]:
    """Return its centre."""
    return light.center


def breadth(light: SphereLight) -> float:
    """Return its radius [m]."""
    return light.radius


def met(light: SphereLight, origin: np.ndarray, direction: np.ndarray) -> float:
    """Return the distance at which a ray meets the sphere, 0 from inside, inf if it does not [m]."""
    out = origin - np.asarray(light.center)
    b, distance = float(out @ direction), float(np.linalg.norm(out))
    beside = float(np.linalg.norm(out - b * direction))  # b^2 less the square of the distance would lose it from afar
    if distance <= light.radius:
        return 0.0
    if b >= 0 or beside >= light.radius:
        return np.inf
    half = float(np.sqrt((light.radius - beside) * (light.radius + beside)))
    return (distance - light.radius) * (distance + light.radius) / (half - b)
