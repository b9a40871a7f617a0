"""How much a map spreads volumes: the determinant of its derivative, by central differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Map = Callable[[np.ndarray], np.ndarray]


def derivative(f: Map, u: np.ndarray, step: float) -> np.ndarray:
    """Return (n, k, k) df/du, the last axis along u, of a map (n, k) -> (n, k) at u (n, k) in the unit cube.

    step  of the way from u to the nearer end of each axis
    """
    n, k = u.shape
    matrix = np.empty((n, k, k))
    for axis in range(k):
        h = step * np.minimum(u[:, axis], 1 - u[:, axis])
        low, high = u.copy(), u.copy()
        low[:, axis] -= h
        high[:, axis] += h
        with np.errstate(all="ignore"):
            matrix[:, :, axis] = (f(high) - f(low)) / (high[:, axis] - low[:, axis])[:, None]
    return matrix


def determinant(f: Map, u: np.ndarray, step: float) -> np.ndarray:
    """Return (n,) its |det df/du|."""
    return np.abs(np.linalg.det(derivative(f, u, step)))
