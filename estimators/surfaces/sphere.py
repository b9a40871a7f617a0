"""The sphere."""

from __future__ import annotations

from fogproof.estimators.kernels.path_data import SPHERE
from fogproof.scene.occluders import Sphere


def place(sphere: Sphere) -> tuple[int, float, float, float, float]:
    """Return kind, vector and size for kernels, see `Wall`."""
    return SPHERE, *sphere.center, sphere.radius
