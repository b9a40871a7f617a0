"""Isotropic scattering: all directions alike (Archimedes: the cosine to any axis is uniform)."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernels.path_data import ISOTROPIC, Lobe
from fogproof.estimators.phase.polar import Polar
from fogproof.scene import Isotropic


def density(phase: Isotropic, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return 1/(4 pi) [1/sr]."""
    return np.full_like(versine, 0.25 / np.pi)


def cosines(phase: Isotropic, xi: np.ndarray, out: np.ndarray) -> None:
    """Write forward cosines."""
    np.multiply(xi, 2, out=out)
    out -= 1


def polar(phase: Isotropic, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf."""
    return Polar(2 * (1 - xi), 2 * xi, np.full_like(xi, 0.25 / np.pi))


def lobe(_phase: Isotropic) -> Lobe:
    """Return it for compiled kernels."""
    return Lobe(ISOTROPIC, 0.0)
