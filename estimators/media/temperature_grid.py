"""A hot grid of voxels for trackers: the grid's extinction, and Planck's law at a collision."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.estimators.media import voxel_grid
from fogproof.scene import Ray
from fogproof.scene.media import TemperatureGrid
from fogproof.scene.shapes import Shape


def kernel_data(medium: TemperatureGrid) -> Any:
    """Return the grid for kernels."""
    return voxel_grid.kernel_data(medium.grid)


def depth(medium: TemperatureGrid, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return the optical depth cell by cell."""
    return np.broadcast_to(voxel_grid.depth(medium.grid, ray, t), (len(t), medium.channels or 1))


def depth_towards(
    medium: TemperatureGrid, x: np.ndarray, w: np.ndarray, way: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the optical depth of many ways, and the cells that each meets."""
    return voxel_grid.depth_towards(medium.grid, x, w, way)


def bounds(
    medium: TemperatureGrid, origin: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> tuple[float, float]:
    """Return those of the grid."""
    return voxel_grid.bounds(medium.grid, origin, direction, length)


def greatest(medium: TemperatureGrid, shape: Shape) -> float:
    """Return that of the grid."""
    return voxel_grid.greatest(medium.grid, shape)


def feature_size(medium: TemperatureGrid, ray: Ray) -> float:
    """Return that of the grid."""
    return voxel_grid.feature_size(medium.grid, ray)


def sources(medium: TemperatureGrid, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return albedo and emission at points x (n, 3) of a grey grid: photons of energy h c/lambda by Bose and Einstein's law."""
    albedo, T = voxel_grid.sources(replace(medium.grid, emission=medium.temperature), x)
    length = float(np.asarray(medium.wavelengths))
    energy = 1.98644586e-25 / length  # h c/lambda [J]
    with np.errstate(divide="ignore", over="ignore", under="ignore"):
        many = 1.0 / np.expm1(np.minimum(energy / (1.380649e-23 * np.maximum(T, 1e-9)), 700.0))
    # Two polarisations, 1/lambda^4 states a volume, solid angle and wavelength, each of c energy many; per nanometre.
    return albedo, np.where(T > 0, 2e-9 * 299792458.0 * energy * many / length**4, 0.0)
