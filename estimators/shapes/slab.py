"""The plane-parallel slab."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.airlight.shapes import Ways, between_planes
from fogproof.estimators.kernels.path_data import LAYER, Region
from fogproof.scene.shapes import Slab


def through(shape: Slab, x: np.ndarray, w: np.ndarray) -> Ways:
    """Return where lines enter and leave."""
    return between_planes(-shape.thickness, 0.0, np.asarray(shape.normal), np.asarray(shape.point), x, w)


def region(shape: Slab) -> Region:
    """Return the shape for kernels."""
    high = float(np.dot(shape.normal, shape.point))
    return Region(LAYER, *shape.normal, high - shape.thickness, high, 0.0)


def farthest(shape: Slab, direction: np.ndarray) -> np.ndarray | None:
    """Return a point on each face if the direction is that of the normal; along any other there is no end."""
    length = float(np.linalg.norm(direction))
    if np.allclose(np.cross(direction, shape.normal), 0, atol=1e-12 * length):
        return np.array([shape.point, np.subtract(shape.point, np.multiply(shape.thickness, shape.normal))])
    return None


def entrances(shape: Slab, _rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return one point and its normal: both faces and all places on them are alike."""
    return np.tile(np.array(shape.point), (n, 1)), np.tile(np.array(shape.normal), (n, 1))
