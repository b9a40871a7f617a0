"""The box along the axes."""

from __future__ import annotations

import math

import numpy as np

from fogproof.scene.shapes import Box


def faces(shape: Box) -> tuple[np.ndarray, np.ndarray]:
    """Return the six faces."""
    return np.concatenate([np.eye(3), -np.eye(3)]), np.concatenate([shape.upper, np.negative(shape.lower)])


def size(shape: Box) -> float:
    """Return the largest coordinate."""
    return float(np.abs([shape.lower, shape.upper]).max())


def mean_chord(shape: Box) -> float:
    """Return 4 V/S [m]."""
    return 2 / math.fsum(1 / np.subtract(shape.upper, shape.lower))
