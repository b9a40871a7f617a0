"""The disk: its shadow is a cone or a cylinder beyond its plane."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.geometry.shadows import Stretch, beyond, dot, where_positive
from fogproof.scene.occluders import Disk


def from_point(occluder: Disk, origin: np.ndarray, d: np.ndarray, light: np.ndarray, margin: np.ndarray) -> Stretch:
    """Return what the occluder hides from a point, its radius larger by `margin`."""
    X, c = origin - light, np.array(occluder.center) - light
    ahead = -dot(X, d)  # distances are counted from the foot of the perpendicular, then from the origin
    X = X + ahead[:, None] * d
    R = occluder.radius + margin
    n = np.array(occluder.normal)
    to_plane = n @ c
    N0, N1 = X @ n, d @ n
    V0, V1 = X * to_plane - N0[:, None] * c, d * to_plane - N1[:, None] * c
    R2, side = R * R, np.sign(to_plane)
    low, high = where_positive(
        R2 * N1 * N1 - dot(V1, V1), R2 * N0 * N1 - dot(V0, V1), R2 * N0 * N0 - dot(V0, V0), N1 * side, N0 * side
    )
    low, high = beyond(low, high, N0 * side - abs(to_plane) + margin, N1 * side)
    # A light in the disk itself may shine to either side, or to none; one beside it in its plane casts no shadow.
    inside, beside = abs(to_plane) <= margin, np.sqrt(max(c @ c - to_plane * to_plane, 0.0))
    low = np.where(inside, np.where(beside <= R, -np.inf, np.nan), np.where(to_plane == 0, np.nan, low))
    high = np.where(inside, np.where(beside <= R, np.inf, np.nan), np.where(to_plane == 0, np.nan, high))
    none = ~((low < high) & (R > 0))
    return np.where(none, np.nan, low + ahead), np.where(none, np.nan, high + ahead)


def from_direction(occluder: Disk, origin: np.ndarray, d: np.ndarray, v: np.ndarray, margin: np.ndarray) -> Stretch:
    """Return what the occluder hides from parallel light, its radius larger by `margin`."""
    X = origin - np.array(occluder.center)
    R = occluder.radius + margin
    n = np.array(occluder.normal)
    facing = n @ v
    with np.errstate(divide="ignore", invalid="ignore"):
        past0, past1 = (X @ n) / facing, (d @ n) / facing
    V0, V1 = X - past0[:, None] * v, d - past1[:, None] * v
    low, high = where_positive(-dot(V1, V1), -dot(V0, V1), R * R - dot(V0, V0))
    low, high = beyond(low, high, past0 + margin / abs(facing), past1)
    none = ~((low < high) & (R > 0))
    return np.where(none, np.nan, low), np.where(none, np.nan, high)
