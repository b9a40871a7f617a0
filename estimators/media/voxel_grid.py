"""Voxels for trackers and samplers."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.estimators.kernels.data import Lattice
from fogproof.estimators.tracking.regular import regular_tracking
from fogproof.scene import Ray, VoxelGrid
from fogproof.scene.shapes import Shape


def kernel_data(medium: VoxelGrid) -> Any:
    """Return the medium for kernels."""
    from fogproof.estimators.kernels.voxels import NearestData, TrilinearData

    kind = NearestData if medium.interpolation == "nearest" else TrilinearData
    shape = medium.sigma_t.shape[:3]
    per_metre = np.array(shape) / (medium.upper - medium.lower)
    return kind(medium.sigma_t.reshape(*shape, -1), np.array(medium.lower), per_metre)


def walk(
    medium: VoxelGrid,
    origin: np.ndarray,
    direction: np.ndarray,
    length: np.ndarray,
    depth: np.ndarray,
    channel: int,
    *results: np.ndarray,
) -> None:
    """Walk through the voxels until an optical depth is reached; results are those of `Walks`."""
    from fogproof.estimators.kernels.regular import through_constant_cells, through_trilinear_cells

    shape = medium.sigma_t.shape[:3]
    trilinear = medium.interpolation == "trilinear"
    lattice = Lattice.between(medium.lower, medium.upper, shape, 0.5 if trilinear else 0.0)
    kernel = through_trilinear_cells if trilinear else through_constant_cells
    kernel(medium.sigma_t.reshape(*shape, -1), channel, lattice, origin, direction, length, depth, *results)


def depth(medium: VoxelGrid, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return the optical depth cell by cell."""
    rays = Ray(ray.origin, ray.direction, np.maximum(t, np.finfo(float).tiny))
    return np.stack([regular_tracking(medium, rays, channel=c).tau for c in range(medium.channels or 1)], axis=-1)


def depth_towards(medium: VoxelGrid, x: np.ndarray, w: np.ndarray, way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the optical depth of many ways, and the number of cells that each meets."""
    walks = regular_tracking(medium, Ray(x.T, w.T, np.maximum(way, np.finfo(float).tiny)))
    return walks.tau, walks.cells


def bounds(medium: VoxelGrid, origin: np.ndarray, direction: np.ndarray, length: np.ndarray) -> tuple[float, float]:
    """Return the least and the greatest extinction of all voxels and channels."""
    return float(medium.sigma_t.min()), float(medium.sigma_t.max())


def greatest(medium: VoxelGrid, shape: Shape) -> float:
    """Return the greatest extinction of all voxels and channels."""
    return float(medium.sigma_t.max())


def feature_size(medium: VoxelGrid, ray: Ray) -> float:
    """Return half a period: voxels h hold frequencies up to 1/(2 h) on each axis, of which w sees the sum of |w|/h."""
    size = (medium.upper - medium.lower) / medium.sigma_t.shape[:3]
    with np.errstate(divide="ignore"):
        return float(1 / np.sum(np.abs(ray.direction) / size))


def sources(medium: VoxelGrid, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return albedo and emission at points x (n, 3) of a grey grid, interpolated as its extinction is."""
    from fogproof.estimators.kernels.tracking import look_up

    data, found = kernel_data(medium), []
    for value in (medium.albedo, medium.emission):
        at = np.broadcast_to(value, (len(x), 1)) if value.ndim == 0 else np.empty((len(x), 1))
        if value.ndim:
            look_up(data._replace(sigma=value[..., None]), np.ascontiguousarray(x), at)
        found.append(at[:, 0])
    return found[0], found[1]
