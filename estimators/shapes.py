"""Where straight ways run through the convex shapes that hold a medium."""

from __future__ import annotations

import numpy as np

from fogproof.scene.shapes import Ball, Box, HalfSpace, Shape, Slab, Unbounded


def through(shape: Shape, x: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the distances (n,) at which the lines from x (3, n) along w (3, n) enter and leave the shape.

    They may be negative or infinite; enter >= leave means that the line misses it.
    """
    everywhere = np.full(x.shape[1], -np.inf), np.full(x.shape[1], np.inf)
    match shape:
        case Unbounded():
            return everywhere
        case HalfSpace(point, normal):
            return _between([(np.asarray(normal), float(np.dot(normal, point)))], x, w)
        case Slab(point, normal, thickness):
            n, at = np.asarray(normal), float(np.dot(normal, point))
            return _between([(n, at), (-n, thickness - at)], x, w)
        case Box(lower, upper):
            faces = [(np.eye(3)[i], upper[i]) for i in range(3)] + [(-np.eye(3)[i], -lower[i]) for i in range(3)]
            return _between(faces, x, w)
        case Ball(center, radius):
            return _ball(np.asarray(center), radius, x, w)


def _between(faces: list[tuple[np.ndarray, float]], x: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Clip the lines by planes (outward normal, offset), one after the other (Cyrus & Beck 1978)."""
    enter, leave = np.full(x.shape[1], -np.inf), np.full(x.shape[1], np.inf)
    for normal, offset in faces:
        inside, slope = offset - normal @ x, normal @ w
        crossing = np.divide(inside, slope, out=np.zeros_like(inside), where=slope != 0)
        leave = np.where(slope > 0, np.minimum(leave, crossing), leave)
        enter = np.where(slope < 0, np.maximum(enter, crossing), enter)
        enter = np.where((slope == 0) & (inside < 0), np.inf, enter)
    return enter, leave


def _ball(center: np.ndarray, radius: float, x: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    towards = center[:, None] - x
    along = np.sum(towards * w, axis=0)
    gap = towards - along * w
    square = radius * radius - np.sum(gap * gap, axis=0)
    half = np.sqrt(np.maximum(square, 0))
    return np.where(square > 0, along - half, np.inf), np.where(square > 0, along + half, -np.inf)
