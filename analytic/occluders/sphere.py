"""The sphere: its shadow is a cone or a cylinder from where that touches it."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.geometry.shadows import Stretch, behind, dot, where_positive
from fogproof.scene.occluders import Sphere


def from_point(occluder: Sphere, origin: np.ndarray, d: np.ndarray, light: np.ndarray, margin: np.ndarray) -> Stretch:
    """Return what the occluder hides from a point, its radius larger by `margin`."""
    X, c = origin - light, np.array(occluder.center) - light
    ahead = -dot(X, d)  # distances are counted from the foot of the perpendicular, then from the origin
    X = X + ahead[:, None] * d
    R = occluder.radius + margin
    tangent2 = (c @ c) - R * R
    along, across = d @ c, X @ c
    cone = where_positive(
        along * along - tangent2, across * along, across * across - dot(X, X) * tangent2, along, across
    )
    half = np.sqrt(R * R - dot(X - c + along[:, None] * d, X - c + along[:, None] * d))

    def before(t: np.ndarray) -> np.ndarray:
        """Whether a place in the cone lies on this side of where the cone touches the ball."""
        return dot(X, X) + t * t < tangent2

    low, high = behind(cone, along - half, along + half, before)
    inside = tangent2 <= 0  # the light is in the ball
    low, high = np.where(inside, -np.inf, low), np.where(inside, np.inf, high)
    none = ~((low < high) & (R > 0))
    return np.where(none, np.nan, low + ahead), np.where(none, np.nan, high + ahead)


def from_direction(occluder: Sphere, origin: np.ndarray, d: np.ndarray, v: np.ndarray, margin: np.ndarray) -> Stretch:
    """Return what the occluder hides from parallel light, its radius larger by `margin`."""
    X = origin - np.array(occluder.center)
    R = occluder.radius + margin
    Xv, dv = np.cross(X, v), np.cross(d, v)
    cylinder = where_positive(-dot(dv, dv), -dot(Xv, dv), R * R - dot(Xv, Xv))
    middle = -dot(X, d)
    nearest = X + middle[:, None] * d
    half = np.sqrt(R * R - dot(nearest, nearest))
    low, high = behind(cylinder, middle - half, middle + half, lambda t: X @ v + t * (d @ v) < 0)
    none = ~((low < high) & (R > 0))
    return np.where(none, np.nan, low), np.where(none, np.nan, high)
