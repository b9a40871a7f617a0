"""Shadow rays: does anything opaque stand between points and a light?"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fogproof.scene.occluders import Disk, Occluder, Sphere


def lit(occluders: Sequence[Occluder], x: np.ndarray, w: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Return (n,) whether the way from points x (3, n) along unit vectors w (3, n) is free for `distance` (n,) [m]."""
    free = np.ones(x.shape[1], dtype=bool)
    for occluder in occluders:
        match occluder:
            case Sphere():
                free &= ~_meets_sphere(occluder, x, w, distance)
            case Disk():
                free &= ~_meets_disk(occluder, x, w, distance)
    return free


def _meets_sphere(sphere: Sphere, x: np.ndarray, w: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """The nearest point of the way to the centre lies within the ball."""
    centre = np.asarray(sphere.center)[:, None] - x
    nearest = np.clip(np.sum(centre * w, axis=0), 0, distance)
    gap = nearest * w - centre
    return np.sum(gap * gap, axis=0) < sphere.radius**2


def _meets_disk(disk: Disk, x: np.ndarray, w: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """The way crosses the plane inside the disk; one in the plane itself does not."""
    normal = np.asarray(disk.normal)
    centre = np.asarray(disk.center)[:, None] - x
    height, slope = normal @ centre, normal @ w
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        crossing = height / slope
    crosses = (crossing > 0) & (crossing < distance)
    gap = np.where(crosses, crossing, 0.0) * w - centre
    return crosses & (np.sum(gap * gap, axis=0) < disk.radius**2)
