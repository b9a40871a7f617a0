"""Ways against a sphere."""

from __future__ import annotations

import numpy as np

from fogproof.scene.occluders import Sphere


def meets(sphere: Sphere, x: np.ndarray, w: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """The nearest point of the way to the centre lies within the ball."""
    centre = np.asarray(sphere.center)[:, None] - x
    nearest = np.clip(np.sum(centre * w, axis=0), 0, distance)
    gap = nearest * w - centre
    return np.sum(gap * gap, axis=0) < sphere.radius**2
