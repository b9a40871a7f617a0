"""The ball."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.airlight.shapes import Ways
from fogproof.estimators.kernels.path_data import BALL, Region
from fogproof.scene.shapes import Ball


def through(shape: Ball, x: np.ndarray, w: np.ndarray) -> Ways:
    """Return the roots of t^2 + 2 b t + c, without cancellation."""
    offset = x - np.asarray(shape.center)[:, None]
    b, c = np.sum(offset * w, axis=0), np.sum(offset * offset, axis=0) - shape.radius * shape.radius
    square = b * b - c
    far = -(b + np.copysign(np.sqrt(np.maximum(square, 0)), b))
    near = np.divide(c, far, out=np.zeros_like(c), where=far != 0)
    missed = square <= 0
    return np.where(missed, np.inf, np.minimum(near, far)), np.where(missed, -np.inf, np.maximum(near, far))


def region(shape: Ball) -> Region:
    """Return the shape for kernels."""
    return Region(BALL, *shape.center, shape.radius, 0.0, 0.0)


def farthest(shape: Ball, direction: np.ndarray) -> np.ndarray:
    """Return the point of the sphere on that side."""
    return np.array([shape.center]) + shape.radius * direction / float(np.linalg.norm(direction))


def entrances(shape: Ball, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points uniform on the sphere and their normals."""
    normal = rng.standard_normal((n, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return np.array(shape.center) + shape.radius * normal, normal
