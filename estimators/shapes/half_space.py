"""The half space."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.airlight.shapes import Ways, between_planes
from fogproof.estimators.kernels.path_data import LAYER, Region
from fogproof.scene.shapes import HalfSpace


def through(shape: HalfSpace, x: np.ndarray, w: np.ndarray) -> Ways:
    """Return where lines enter and leave."""
    return between_planes(-np.inf, 0.0, np.asarray(shape.normal), np.asarray(shape.point), x, w)


def region(shape: HalfSpace) -> Region:
    """Return the shape for kernels."""
    return Region(LAYER, *shape.normal, -np.inf, float(np.dot(shape.normal, shape.point)), 0.0)
