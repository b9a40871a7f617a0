"""The pinhole camera."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.cameras.frame import frame
from fogproof.scene import Perspective, Ray


def rays(camera: Perspective, x: np.ndarray, y: np.ndarray) -> Ray:
    """Return rays through places of the film; their length ends them on the wall."""
    axes, film = frame(camera.origin, camera.target, camera.up), camera.film
    scale = 2 * camera.half_width / film.width
    across, down = scale * (x - 0.5 * film.width), scale * (y - 0.5 * film.height)
    direction = axes.ahead + across[..., None] * axes.right - down[..., None] * axes.up
    slant = np.linalg.norm(direction, axis=-1)
    return Ray(np.array(camera.origin), direction / slant[..., None], camera.wall * slant)
