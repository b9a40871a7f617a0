"""Where straight ways run through the convex shapes that hold a medium: pairs of parallel planes (Kay & Kajiya 1986), and balls."""

from __future__ import annotations

import numpy as np

from fogproof.scene.shapes import Ball, Box, HalfSpace, Shape, Slab, Unbounded

Ways = tuple[np.ndarray, np.ndarray]


def through(shape: Shape, x: np.ndarray, w: np.ndarray) -> Ways:
    """Return the distances (n,) at which the lines from x (3, n) along w (3, n) enter and leave the shape.

    They may be negative or infinite; enter >= leave means that the line misses it.
    """
    match shape:
        case Unbounded():
            return np.full(x.shape[1], -np.inf), np.full(x.shape[1], np.inf)
        case HalfSpace(point, normal):
            return _layer(-np.inf, 0.0, np.asarray(normal), np.asarray(point), x, w)
        case Slab(point, normal, thickness):
            return _layer(-thickness, 0.0, np.asarray(normal), np.asarray(point), x, w)
        case Box(lower, upper):
            layers = [_layer(lower[i], upper[i], np.eye(3)[i], np.zeros(3), x, w) for i in range(3)]
            return np.max([enter for enter, _ in layers], axis=0), np.min([leave for _, leave in layers], axis=0)
        case Ball(center, radius):
            return _ball(np.asarray(center), radius, x, w)


def _layer(low: float, high: float, normal: np.ndarray, point: np.ndarray, x: np.ndarray, w: np.ndarray) -> Ways:
    """The points whose height over `point` along the normal lies between low and high."""
    height, rise = normal @ (x - point[:, None]), normal @ w
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        one, two = (low - height) / rise, (high - height) / rise
    level, inside = rise == 0, (low <= height) & (height <= high)
    enter = np.where(level, np.where(inside, -np.inf, np.inf), np.minimum(one, two))
    return enter, np.where(level, np.where(inside, np.inf, -np.inf), np.maximum(one, two))


def _ball(center: np.ndarray, radius: float, x: np.ndarray, w: np.ndarray) -> Ways:
    """The roots of t^2 + 2 b t + c, without cancellation."""
    offset = x - center[:, None]
    b, c = np.sum(offset * w, axis=0), np.sum(offset * offset, axis=0) - radius * radius
    square = b * b - c
    far = -(b + np.copysign(np.sqrt(np.maximum(square, 0)), b))
    near = np.divide(c, far, out=np.zeros_like(c), where=far != 0)
    missed = square <= 0
    return np.where(missed, np.inf, np.minimum(near, far)), np.where(missed, -np.inf, np.maximum(near, far))
