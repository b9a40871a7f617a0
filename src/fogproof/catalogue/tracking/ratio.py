"""Ratio and residual ratio tracking against the oracle: mean, variance and look-ups."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.catalogue.cases import Case, Drawn
from fogproof.catalogue.tracking.scenes import (
    EXPONENTIAL,
    LINEAR,
    RAY,
    cloud,
    compiled_waves,
    noise_medium,
    transmittance_case,
    waves,
)
from fogproof.catalogue.twins.trackers import LiteralTracker, decimal
from fogproof.contracts import Draws
from fogproof.estimators import (
    RatioTransmittance,
    ResidualRatioTransmittance,
)
from fogproof.scene import AnyMedium, Procedural


def cases() -> list[Case]:
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
