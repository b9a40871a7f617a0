"""The box along the axes."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.airlight.shapes import Ways, between_planes
from fogproof.estimators.kernels.path_data import BOX, Region
from fogproof.scene.shapes import Box


def through(shape: Box, x: np.ndarray, w: np.ndarray) -> Ways:
    """Return where lines are between all three pairs of planes."""
    lower, upper = shape.lower, shape.upper
    layers = [between_planes(lower[i], upper[i], np.eye(3)[i], np.zeros(3), x, w) for i in range(3)]
    return np.max([enter for enter, _ in layers], axis=0), np.min([leave for _, leave in layers], axis=0)


def region(shape: Box) -> Region:
    """Return the shape for kernels."""
    return Region(BOX, *shape.lower, *shape.upper)


def farthest(shape: Box, direction: np.ndarray) -> np.ndarray:
    """Return a corner."""
    return np.where(direction > 0, shape.upper, shape.lower)[None]


def entrances(shape: Box, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points on the six faces, each by its area, and their normals."""
    low, high = np.array(shape.lower), np.array(shape.upper)
    sides = high - low
    area = np.prod(sides) / sides
    axis = rng.choice(3, n, p=area / area.sum())
    side = rng.integers(0, 2, n)
    point, normal = low + rng.random((n, 3)) * sides, np.zeros((n, 3))
    rows = np.arange(n)
    point[rows, axis] = np.where(side == 1, high[axis], low[axis])
    normal[rows, axis] = 2 * side - 1
    return point, normal
