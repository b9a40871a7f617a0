"""The half space."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.lights.environment import Answer, between_planes
from fogproof.scene.phase import PhaseFunction
from fogproof.scene.shapes import HalfSpace


def faces(shape: HalfSpace) -> tuple[np.ndarray, np.ndarray]:
    """Return the one face."""
    normals = np.array([shape.normal])
    return normals, normals @ np.array(shape.point)


def size(shape: HalfSpace) -> float:
    """Return the largest coordinate."""
    return float(np.abs(shape.point).max())


def environment(
    shape: HalfSpace,
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
