"""Where straight ways run through the convex shapes that hold a medium."""

from __future__ import annotations

import numpy as np

from fogproof.scene.kinds import given
from fogproof.scene.shapes import Shape

ROOM = "fogproof.estimators.shapes"
Ways = tuple[np.ndarray, np.ndarray]


def through(shape: Shape, x: np.ndarray, w: np.ndarray) -> Ways:
    """Return the distances (n,) at which the lines from x (3, n) along w (3, n) enter and leave the shape.

    They may be negative or infinite; enter >= leave means that the line misses it.
    """
    ways: Ways = given(shape, ROOM, "through")(shape, x, w)
    return ways


def between_planes(
    low: float, high: float, normal: np.ndarray, point: np.ndarray, x: np.ndarray, w: np.ndarray
) -> Ways:
    """The points whose height over `point` along the normal lies between low and high (Kay & Kajiya 1986)."""
    height, rise = normal @ (x - point[:, None]), normal @ w
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        one, two = (low - height) / rise, (high - height) / rise
    level, inside = rise == 0, (low <= height) & (height <= high)
    enter = np.where(level, np.where(inside, -np.inf, np.inf), np.minimum(one, two))
    return enter, np.where(level, np.where(inside, np.inf, -np.inf), np.maximum(one, two))
