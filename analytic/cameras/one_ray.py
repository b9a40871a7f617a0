"""The camera of one ray."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.cameras.frame import frame
from fogproof.scene import OneRay, Ray

same = True


def rays(camera: OneRay, x: np.ndarray, y: np.ndarray) -> Ray:
    """Return the same ray for every place of the film."""
    ahead = frame(camera.origin, camera.target, camera.up).ahead
    return Ray(np.broadcast_to(camera.origin, (*np.broadcast_shapes(x.shape, y.shape), 3)), ahead, camera.wall)
