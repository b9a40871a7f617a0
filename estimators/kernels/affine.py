"""A medium moved by an affine map, for kernels."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.estimators.kernels.media import sigma_t


class AffineData(NamedTuple):
    """A medium, the map (3, 4) from the world to its own coordinates, and the corners outside of which it is vacuum there."""

    inner: Any
    to_own: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        m, low, high = medium.to_own, medium.lower, medium.upper
        u = m[0, 0] * x + m[0, 1] * y + m[0, 2] * z + m[0, 3]
        v = m[1, 0] * x + m[1, 1] * y + m[1, 2] * z + m[1, 3]
        w = m[2, 0] * x + m[2, 1] * y + m[2, 2] * z + m[2, 3]
        if u < low[0] or u >= high[0] or v < low[1] or v >= high[1] or w < low[2] or w >= high[2]:
            return 0.0
        return sigma_t(medium.inner, channel, u, v, w)
