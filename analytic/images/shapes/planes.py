"""Rays and planes: the cosine of each ray to a layer's normal, and its azimuth to the light's."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.scene import Ray


def cosines(
    ray: Ray, normal: tuple[float, float, float], point: tuple[float, float, float], depth: float
) -> np.ndarray:
    """Return the cosine of each ray to the normal, > 0 for rays that look down onto the layer; cameras must be outside.

    depth  of the layer below the plane [m]
    """
    height = (ray.origin - np.array(point)) @ np.array(normal)
    down = -(ray.direction @ np.array(normal))
    outside = (height >= 0) & (down > 0) | (height <= -depth) & (down < 0)
    if not outside.all():
        raise UnsupportedError(
            "multiple scattering is known to a camera outside that looks at the medium only", "camera"
        )
    return down


def azimuth(ray: Ray, normal: tuple[float, float, float], travel: np.ndarray) -> np.ndarray:
    """Return the angle between the horizontal directions of light before and after scattering [rad]."""
    up = np.array(normal)
    a, b = travel - (travel @ up) * up, -(ray.direction - (ray.direction @ up)[:, None] * up)
    if np.linalg.norm(a) < 1e-12:
        return np.zeros(len(b))
    cross = np.cross(np.broadcast_to(a, b.shape), b) @ up
    return np.abs(np.arctan2(cross, b @ a))


def each(cosine: np.ndarray, answer: Any, *more: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return value and error of an answer that is asked once for each different argument."""
    table, back = np.unique(np.stack([cosine, *more], axis=1), axis=0, return_inverse=True)
    found = answer(*table.T)
    return found.value[back.ravel()], found.error[back.ravel()]
