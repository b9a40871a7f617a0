"""Trackers through heterogeneous media against the oracle: mean, variance and look-ups, or the density of distances."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.analytic import transmittance
from fogproof.catalogue.cases import Case, Drawn, EstimatorCase, Twin
from fogproof.catalogue.tracking.scenes import (
    EXPONENTIAL,
    LINEAR,
    RAY,
    WALK,
    WOODCOCK,
    cloud,
    compiled_waves,
    distance_case,
    noise_medium,
    transmittance_case,
    waves,
)
from fogproof.catalogue.twins.trackers import LiteralDelta, LiteralTracker, decimal
from fogproof.contracts import Draws
from fogproof.estimators import (
    DeltaFreePath,
    DeltaTransmittance,
    RatioTransmittance,
    RegularFreePath,
    RegularTransmittance,
    ResidualRatioTransmittance,
)
from fogproof.scene import AnyMedium, Medium, Procedural, VoxelGrid


def _regular() -> list[Case]:
    """Return the cases of regular tracking: no variance at all in the transmittance, one uniform in the distance."""
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


def _delta() -> list[Case]:
    """Return the cases of delta tracking: hits and misses, and the distance itself."""
    trilinear, noise, user = cloud("trilinear"), noise_medium(), Procedural(waves, 1.5, detail=0.5)

    def broken(medium: AnyMedium, majorant: float, **error: Any) -> Callable[[], Any]:
        return lambda: LiteralDelta(LiteralTracker(medium, RAY, majorant, **error))

    def every_collision(rng: np.random.Generator, n: int) -> np.ndarray:
        return LiteralTracker(EXPONENTIAL, RAY, 1.4, certain=True).fly(rng, n)[0]

    def clamped(rng: np.random.Generator, n: int) -> np.ndarray:
        return LiteralTracker(trilinear, RAY, 0.5).fly(rng, n)[0]

    return [
        transmittance_case(
            "delta/linear",
            "Delta tracking, linear extinction, tight majorant",
            lambda: DeltaTransmittance(LINEAR, RAY),
            LINEAR,
            "delta",
            float(LINEAR.sigma_0 + LINEAR.gradient @ (RAY.origin + 1.75 * RAY.direction)),
            "majorant too small, the probability clamped to 1",
            broken(LINEAR, 0.6),
        ),
        transmittance_case(
            "delta/exponential",
            "Delta tracking, exponential extinction, loose majorant",
            lambda: DeltaTransmittance(EXPONENTIAL, RAY, 4.0),
            EXPONENTIAL,
            "delta",
            4.0,
            "flights by the decimal logarithm",
            broken(EXPONENTIAL, 4.0, steps=decimal),
        ),
        transmittance_case(
            "delta/trilinear",
            "Delta tracking, trilinear voxels",
            lambda: DeltaTransmittance(trilinear, RAY, 2.5),
            trilinear,
            "delta",
            2.5,
            "flights counted from the start of the ray",
            broken(trilinear, 2.5, from_start=True),
        ),
        transmittance_case(
            "delta/noise",
            "Delta tracking, fractal noise",
            lambda: DeltaTransmittance(noise, RAY),
            noise,
            "delta",
            2.0,
            "fictitious collisions taken for real",
            lambda: DeltaTransmittance(Medium(2.0, 0.0), RAY),
            samples=300_000,
        ),
        transmittance_case(
            "delta/array-function",
            "Delta tracking, a user's array function",
            lambda: DeltaTransmittance(user, RAY),
            user,
            "delta",
            1.5,
            "majorant too small, the probability clamped to 1",
            broken(user, 0.9),
            samples=300_000,
        ),
        distance_case(
            "delta/free-path/exponential",
            "Free path by delta tracking, exponential extinction",
            lambda: DeltaFreePath(EXPONENTIAL, RAY),
            EXPONENTIAL,
            RAY,
            WOODCOCK,
            "fictitious collisions taken for real",
            every_collision,
        ),
        distance_case(
            "delta/free-path/trilinear",
            "Free path by delta tracking, trilinear voxels",
            lambda: DeltaFreePath(trilinear, RAY),
            trilinear,
            RAY,
            WOODCOCK,
            "majorant too small, the probability clamped to 1",
            clamped,
        ),
    ]


def _ratio() -> list[Case]:
    """Return the cases of ratio and residual ratio tracking."""
    nearest, noise, user = cloud("nearest"), noise_medium(), Procedural(waves, 1.5, detail=0.5)
    residual = ResidualRatioTransmittance

    def broken(medium: AnyMedium, majorant: float, **error: Any) -> Callable[[], Any]:
        return lambda: LiteralTracker(medium, RAY, majorant, **error)

    def altered(estimator: Any, change: Callable[[np.ndarray], np.ndarray]) -> Callable[[], Drawn]:
        def draw(rng: np.random.Generator, n: int) -> Draws:
            draws = estimator.draw(rng, n)
            return draws._replace(value=change(np.asarray(draws.value)))

        return lambda: Drawn(draw)

    return [
        transmittance_case(
            "ratio/linear",
            "Ratio tracking, linear extinction",
            lambda: RatioTransmittance(LINEAR, RAY, 2.0),
            LINEAR,
            "ratio",
            2.0,
            "weighted by sigma / majorant, not 1 - sigma / majorant",
            broken(LINEAR, 2.0, factor=lambda sigma, majorant: sigma / majorant),
        ),
        transmittance_case(
            "ratio/exponential",
            "Ratio tracking, exponential extinction, loose majorant",
            lambda: RatioTransmittance(EXPONENTIAL, RAY, 6.0),
            EXPONENTIAL,
            "ratio",
            6.0,
            "flights by the decimal logarithm",
            broken(EXPONENTIAL, 6.0, steps=decimal),
            samples=300_000,
        ),
        transmittance_case(
            "ratio/nearest",
            "Ratio tracking, nearest voxels",
            lambda: RatioTransmittance(nearest, RAY, 2.5),
            nearest,
            "ratio",
            2.5,
            "tracking ends after the first tentative collision",
            broken(nearest, 2.5, once=True),
        ),
        transmittance_case(
            "ratio/noise",
            "Ratio tracking, fractal noise",
            lambda: RatioTransmittance(noise, RAY),
            noise,
            "ratio",
            2.0,
            "every weight applied twice",
            altered(RatioTransmittance(noise, RAY), np.square),
            samples=300_000,
        ),
        transmittance_case(
            "ratio/numba-function",
            "Ratio tracking, a user's numba function",
            lambda: RatioTransmittance(Procedural(compiled_waves(), 1.5, detail=0.5), RAY),
            user,
            "ratio",
            1.5,
            "flights and weights with two different majorants",
            broken(user, 1.5, factor=lambda sigma, majorant: 1 - sigma / (majorant + 0.2)),
            samples=300_000,
        ),
        transmittance_case(
            "residual-ratio/linear",
            "Residual ratio tracking, linear extinction",
            lambda: residual(LINEAR, RAY, 2.0, 0.5),
            LINEAR,
            "residual-ratio",
            1.5,
            "the transmittance of the control is forgotten",
            altered(residual(LINEAR, RAY, 2.0, 0.5), lambda value: value * np.exp(0.5 * 1.75)),
            control=0.5,
        ),
        transmittance_case(
            "residual-ratio/noise",
            "Residual ratio tracking, fractal noise",
            lambda: residual(noise, RAY, 2.0, 0.2),
            noise,
            "residual-ratio",
            1.8,
            "the transmittance of the control counts twice",
            altered(residual(noise, RAY, 2.0, 0.2), lambda value: value * np.exp(-0.2 * 1.75)),
            control=0.2,
            samples=500_000,
        ),
    ]


def cases() -> list[Case]:
    """Return the cases of trackers."""
    return [*_regular(), *_delta(), *_ratio()]
