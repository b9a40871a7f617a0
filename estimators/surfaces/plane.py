"""The endless plane."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernels.path_data import PLANE
from fogproof.scene.surfaces import Plane


def place(plane: Plane) -> tuple[int, float, float, float, float]:
    """Return kind, vector and size for kernels, see `Wall`."""
    return PLANE, *plane.normal, float(np.dot(plane.normal, plane.point))
