"""The ball."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.airlight.shapes import Ways
from fogproof.estimators.kernels.path_data import BALL, Region
from fogproof.scene.shapes import Ball


def through(shape: Ball, x: np.ndarray, w: np.ndarray) -> Ways:
    """Return the roots of t^2 + 2 b t + c, without cancellation.

    Half the chord comes from the distance of the line from the centre: b^2 - c would lose it to the square of the way there.
    """
    offset = x - np.asarray(shape.center)[:, None]
    b, distance = np.sum(offset * w, axis=0), np.sqrt(np.sum(offset * offset, axis=0))
    off_centre = offset - b * w
    beside = np.sqrt(np.sum(off_centre * off_centre, axis=0))
    square = (shape.radius - beside) * (shape.radius + beside)
    far = -(b + np.copysign(np.sqrt(np.maximum(square, 0)), b))
    c = (distance - shape.radius) * (distance + shape.radius)
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
