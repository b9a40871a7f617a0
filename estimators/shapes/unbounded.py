"""All of space."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.airlight.shapes import Ways
from fogproof.estimators.kernels.path_data import SPACE, Region
from fogproof.scene.shapes import Unbounded


def through(_shape: Unbounded, x: np.ndarray, _w: np.ndarray) -> Ways:
    """Return -inf and inf."""
    return np.full(x.shape[1], -np.inf), np.full(x.shape[1], np.inf)


def region(_shape: Unbounded) -> Region:
    """Return the shape for kernels."""
    return Region(SPACE, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
