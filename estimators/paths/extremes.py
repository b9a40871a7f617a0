"""Which points of a shape are farthest along a vector."""

from __future__ import annotations

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.scene.kinds import given
from fogproof.scene.shapes import Shape


def extremes(vector: np.ndarray, shape: Shape) -> np.ndarray:
    """Return points (k, 3) of a shape among which is the one farthest along a vector (3,)."""
    length = float(np.linalg.norm(vector))
    if length == 0:
        return np.zeros((1, 3))
    farthest = given(shape, "fogproof.estimators.shapes", "farthest")
    points = None if farthest is None else farthest(shape, vector)
    if points is not None:
        return np.asarray(points)
    fix = "give a majorant, or a shape in which it is bounded"
    raise UnsupportedError(f"the extinction is not bounded in this {type(shape).__name__}; {fix}", "majorant")
