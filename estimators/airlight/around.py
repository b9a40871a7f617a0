"""Directions about many axes at once."""

from __future__ import annotations

import numpy as np


def around(axis: np.ndarray, versine: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Return unit vectors (3, n) at 1 - cos = versine and azimuth phi from unit vectors (3, n).

    Source of the frame: Duff et al. 2017, Building an orthonormal basis, revisited.
    """
    x, y, z = axis
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    sine = np.sqrt(np.maximum(versine * (2 - versine), 0.0))
    u, v = sine * np.cos(phi), sine * np.sin(phi)
    first = np.stack([1.0 + sign * x * x * a, sign * b, -sign * x])
    second = np.stack([b, sign + y * y * a, -y])
    result: np.ndarray = u * first + v * second + (1 - versine) * axis
    return result
