"""A hot grid of voxels: the grid's own thickness, and Planck's law of the temperature at a point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fogproof.analytic.geometry.rays import Thickness
from fogproof.analytic.media import voxel_grid
from fogproof.analytic.media.black_body import planck
from fogproof.analytic.media.breakpoints import Breaks
from fogproof.analytic.media.coefficients import Coefficients, Points
from fogproof.scene import Ray
from fogproof.scene.media import TemperatureGrid


def coefficients(medium: TemperatureGrid, at: Points) -> Coefficients:
    """Return those of the grid, and the radiance of a black body of the temperature that the grid has there."""
    hot = replace(medium.grid, sigma_t=medium.temperature, albedo=0.0)
    grey = at._replace(place=at.x, shape=at.x.shape[:-1])
    T = np.asarray(voxel_grid.coefficients(hot, grey).sigma_t)
    if len(at.shape) == at.x.ndim:
        T = T[..., None]
    emission, _ = planck(*np.broadcast_arrays(T, np.asarray(medium.wavelengths, float)))
    return voxel_grid.coefficients(medium.grid, at)._replace(emission=emission)


def breakpoints(medium: TemperatureGrid, origin: np.ndarray, direction: np.ndarray, length: np.ndarray) -> Breaks:
    """Return those of the grid."""
    return voxel_grid.breakpoints(medium.grid, origin, direction, length)


def thickness(medium: TemperatureGrid, ray: Ray, channels: int | None) -> Thickness:
    """Return that of the grid."""
    return voxel_grid.thickness(medium.grid, ray, channels)
