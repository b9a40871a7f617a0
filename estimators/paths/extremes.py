"""Which points of a shape are farthest along a vector."""

from __future__ import annotations

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.scene.shapes import Ball, Box, Shape, Slab


def extremes(vector: np.ndarray, shape: Shape) -> np.ndarray:
    """Return points (k, 3) of a shape among which is the one farthest along a vector (3,)."""
    length = float(np.linalg.norm(vector))
    if length == 0:
        return np.zeros((1, 3))
    match shape:
        case Ball(center, radius):
            return np.array([center]) + radius * vector / length
        case Box(lower, upper):
            return np.where(vector > 0, upper, lower)[None]
        case Slab(point, normal, thickness) if np.allclose(np.cross(vector, normal), 0, atol=1e-12 * length):
            return np.array([point, np.subtract(point, np.multiply(thickness, normal))])
    fix = "give a majorant, or a shape in which it is bounded"
    raise UnsupportedError(f"the extinction is not bounded in this {type(shape).__name__}; {fix}", "majorant")
