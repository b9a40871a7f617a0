"""The plane-parallel slab."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.lights.environment import Answer, between_planes
from fogproof.scene.phase import PhaseFunction
from fogproof.scene.shapes import Slab


def faces(shape: Slab) -> tuple[np.ndarray, np.ndarray]:
    """Return both faces."""
    offset = float(np.dot(shape.normal, shape.point))
    return np.array([shape.normal, np.negative(shape.normal)]), np.array([offset, shape.thickness - offset])


def size(shape: Slab) -> float:
    """Return the largest coordinate."""
    return float(np.abs(shape.point).max() + shape.thickness)


def mean_chord(shape: Slab) -> float:
    """Return 4 V/S [m]."""
    return 2 * shape.thickness


def environment(
    shape: Slab,
    phase: PhaseFunction,
    origin: np.ndarray,
    d: np.ndarray,
    sigma: np.ndarray,
    start: float,
    end: float,
    fine: int,
) -> Answer:
    """Return what arrives from all around: symmetric about the normal."""
    return between_planes(*faces(shape), phase, origin, d, sigma, start, end, fine)
