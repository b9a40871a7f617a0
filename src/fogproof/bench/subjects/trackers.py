"""Trackers: a ray, against masked NumPy that tracks all rays a step at a time; regular tracking a cell."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.bench.benchmark import Benchmark, Goal, Way
from fogproof.estimators import delta_tracking, ratio_tracking, regular_tracking
from fogproof.scene import Procedural, Ray, VoxelGrid

RAYS, VOXELS, MAJORANT = 4096, 64, 10.0


def _cloud(kind: Any) -> VoxelGrid:
    """Return waves in the unit cube, at most 10/m."""
    x = (np.arange(VOXELS) + 0.5) / VOXELS
    wave = np.sin(5 * x)[:, None, None] ** 2 * np.sin(7 * x)[None, :, None] ** 2 * np.sin(6 * x) ** 2
    return VoxelGrid(MAJORANT * wave, (0, 0, 0), (1, 1, 1), kind)


def _rays(rng: np.random.Generator) -> Ray:
    direction = rng.normal(size=(RAYS, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return Ray(rng.random((RAYS, 3)) - 2 * direction, direction, 6.0)


def _by_hand(grid: VoxelGrid) -> Procedural:
    """Return trilinear interpolation as a NumPy programmer writes it."""
    values, last = grid.sigma_t, VOXELS - 1

    def sigma_t(x: np.ndarray) -> np.ndarray:
        u = np.clip(x * VOXELS - 0.5, 0, last)
        low = u.astype(np.int64)
        total, part = np.zeros(len(x)), u - low
        for corner in np.ndindex(2, 2, 2):
            index = np.minimum(low + corner, last)
            weight = np.prod(np.where(corner, part, 1 - part), axis=1)
            total += weight * values[index[:, 0], index[:, 1], index[:, 2]]
        return total

    return Procedural(sigma_t, MAJORANT, lower=(0, 0, 0), upper=(1, 1, 1))


def _ways() -> dict[str, Way]:
    rng = np.random.default_rng(1)
    trilinear, nearest, rays = _cloud("trilinear"), _cloud("nearest"), _rays(rng)
    masked = _by_hand(trilinear)
    cells = float(regular_tracking(nearest, rays).cells.sum())
    return {
        "delta": Way(lambda: delta_tracking(trilinear, rays, rng, MAJORANT), RAYS),
        "delta, masked NumPy": Way(lambda: delta_tracking(masked, rays, rng, MAJORANT), RAYS),
        "ratio": Way(lambda: ratio_tracking(trilinear, rays, rng, MAJORANT), RAYS),
        "ratio, masked NumPy": Way(lambda: ratio_tracking(masked, rays, rng, MAJORANT), RAYS),
        "regular": Way(lambda: regular_tracking(nearest, rays), RAYS),
        "regular, a cell": Way(lambda: regular_tracking(nearest, rays), cells),
    }


def benchmarks() -> list[Benchmark]:
    """Return them."""
    goals = {"delta, masked NumPy": Goal(">=", 3.0), "regular, a cell": Goal("<=", 0.2)}
    return [Benchmark("trackers", "Trackers through a cube of 64^3 voxels", "ray", "delta", _ways, goals)]
