"""The disk that shines: places uniform on it."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.airlight.around import around
from fogproof.estimators.airlight.lighting import Sampled
from fogproof.estimators.grey import grey
from fogproof.scene.lights import DiskLight


def sample(light: DiskLight, x: np.ndarray, u: np.ndarray) -> Sampled:
    """Return directions from points x (3, n) to places uniform on the disk, from uniforms u (n, 2); none from behind."""
    normal = np.asarray(light.normal)
    across = around(np.tile(normal[:, None], len(u)), np.ones(len(u)), 2 * np.pi * u[:, 1])
    to = np.asarray(light.center)[:, None] + light.radius * np.sqrt(u[:, 0]) * across - x
    square = np.sum(to * to, axis=0)
    way = np.sqrt(square)
    with np.errstate(divide="ignore", invalid="ignore"):
        w = to / way
        cosine = np.maximum(-(normal @ w), 0.0)
        solid = np.pi * light.radius * light.radius * cosine / square
    return Sampled(w, way, grey("radiance", light.radiance) * solid)


def focus(light: DiskLight) -> tuple[float, float, float]:
    """Return its centre."""
    return light.center


def breadth(light: DiskLight) -> float:
    """Return its radius [m]."""
    return light.radius


def met(light: DiskLight, origin: np.ndarray, direction: np.ndarray) -> float:
    """Return the distance at which a ray meets the disk, from either side, inf if it does not [m]."""
    normal, out = np.asarray(light.normal), np.asarray(light.center) - origin
    rise = float(normal @ direction)
    if rise == 0:
        return np.inf
    t = float(normal @ out) / rise
    there = t * direction - out
    return t if t > 0 and there @ there <= light.radius * light.radius else np.inf
