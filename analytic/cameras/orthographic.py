"""The camera of parallel rays."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.cameras.frame import frame
from fogproof.scene import Orthographic, Ray


def rays(camera: Orthographic, x: np.ndarray, y: np.ndarray) -> Ray:
    """Return rays from places of the film; they all end on the wall."""
    axes, film = frame(camera.origin, camera.target, camera.up), camera.film
    scale = camera.width / film.width
    across, down = scale * (x - 0.5 * film.width), scale * (y - 0.5 * film.height)
    origin = np.array(camera.origin) + across[..., None] * axes.right - down[..., None] * axes.up
    return Ray(origin, axes.ahead, camera.wall)
