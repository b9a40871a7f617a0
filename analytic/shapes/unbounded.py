"""All of space: no face anywhere."""

from __future__ import annotations

import numpy as np

from fogproof.scene.shapes import Unbounded


def faces(_shape: Unbounded) -> tuple[np.ndarray, np.ndarray]:
    """Return none."""
    return np.empty((0, 3)), np.empty(0)


def size(_shape: Unbounded) -> float:
    """Return 0: it has no coordinates."""
    return 0.0
