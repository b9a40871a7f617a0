"""What graded media with a vector a channel have in common."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.scene import Ray


def rows(value: Any, vectors: np.ndarray, channels: int | None) -> tuple[np.ndarray, np.ndarray]:
    """Return a value (channels,) and a vector (channels, 3) for each channel, one if the medium is grey."""
    count = channels or 1
    return np.array(np.broadcast_to(value, count)), np.array(np.broadcast_to(vectors, (count, 3)))


def slopes(value: Any, vectors: np.ndarray, ray: Ray) -> tuple[np.ndarray, np.ndarray]:
    """Return value + vector . x at the start of the ray and its slope along it, (channels,) each."""
    vectors = np.atleast_2d(vectors)
    return value + vectors @ ray.origin, vectors @ ray.direction
