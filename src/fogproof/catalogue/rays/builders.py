"""The ray of the cases along one ray."""

from __future__ import annotations

from fogproof.scene import Ray

START = ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))


def ray_to(length: float) -> Ray:
    """Return the ray of a length [m] from the origin along +z."""
    return Ray(*START, length)
