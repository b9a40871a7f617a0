"""Regular tracking against the oracle: no variance at all in the transmittance, one uniform in the distance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fogproof.analytic import transmittance
from fogproof.catalogue.cases import Case, EstimatorCase, Twin
from fogproof.catalogue.tracking.scenes import (
    RAY,
    WALK,
    cloud,
    distance_case,
)
from fogproof.estimators import (
    RegularFreePath,
    RegularTransmittance,
)
from fogproof.scene import VoxelGrid


def cases() -> list[Case]:
    """Return the cases of regular tracking."""
    nearest, trilinear = cloud("nearest"), cloud("trilinear")
    rolled = replace(nearest, sigma_t=np.roll(nearest.sigma_t, 1, axis=2))
    half = (nearest.upper - nearest.lower) / nearest.sigma_t.shape / 2
    shifted = replace(trilinear, lower=trilinear.lower - half, upper=trilinear.upper - half)

    def exact(kind: str, grid: VoxelGrid, error: str, twin: VoxelGrid) -> EstimatorCase:
        return EstimatorCase(
            name=f"tracking/regular/{kind}",
            title=f"Regular tracking, {kind} voxels",
            make=lambda: RegularTransmittance(grid, RAY),
            reference=lambda: transmittance(grid, RAY),
            variance=lambda: 0.0,
            oracle="transmittance",
            source=WALK,
            twin=Twin(error, lambda: RegularTransmittance(twin, RAY)),
            samples=1000,
        )

    def uninterpolated(u: np.ndarray) -> np.ndarray:
        return RegularFreePath(nearest, RAY).sample(u).x

    def uniform_in_the_cell(u: np.ndarray) -> np.ndarray:
        sampler = RegularFreePath(nearest, RAY)
        x, h = sampler.sample(u).x, 0.1
        return np.where(x < float(RAY.length), np.floor(x / h) * h + h * np.modf(u[:, 0] * 997)[0], x)

    return [
        exact("nearest", nearest, "the index along z is one too high", rolled),
        exact("trilinear", trilinear, "values taken to stand at corners instead of centres", shifted),
        distance_case(
            "regular/free-path/nearest",
            "Free path by regular tracking, nearest voxels",
            lambda: RegularFreePath(nearest, RAY),
            nearest,
            RAY,
            WALK,
            "uniform within steps of 10 cm instead of exponential",
            uniform_in_the_cell,
        ),
        distance_case(
            "regular/free-path/trilinear",
            "Free path by regular tracking, trilinear voxels",
            lambda: RegularFreePath(trilinear, RAY),
            trilinear,
            RAY,
            WALK,
            "the voxels' values are not interpolated",
            uninterpolated,
        ),
    ]
