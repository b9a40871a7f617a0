"""Delta tracking against the oracle: hits and misses, and the density of distances."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.catalogue.cases import Case
from fogproof.catalogue.tracking.scenes import (
    EXPONENTIAL,
    LINEAR,
    RAY,
    WOODCOCK,
    cloud,
    distance_case,
    noise_medium,
    transmittance_case,
    waves,
)
from fogproof.catalogue.twins.trackers import LiteralDelta, LiteralTracker, decimal
from fogproof.estimators import (
    DeltaFreePath,
    DeltaTransmittance,
)
from fogproof.scene import AnyMedium, Medium, Procedural


def cases() -> list[Case]:
    """Return the cases of delta tracking."""
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
