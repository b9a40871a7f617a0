"""Trackers under a majorant in blocks of space."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.analytic import (
    emitted_radiance,
    optical_thickness,
    transmittance,
    transmittance_variance,
)
from fogproof.catalogue.cases import Case, Drawn, EstimatorCase, Twin
from fogproof.catalogue.tracking.scenes import NOVAK, RAY, WALK, WOODCOCK, cloud
from fogproof.contracts import Draws, Reference
from fogproof.estimators import DeltaTransmittance, MajorantGrid, RatioTransmittance
from fogproof.scene import Ray


def cases() -> list[Case]:
    """Return the cases of a majorant in blocks: where the medium is a grid of constants, so are all integrals over it."""
    grid = cloud("nearest")
    bound = MajorantGrid.of(grid, 2)
    high = np.kron(bound.high, np.ones((2, 2, 2)))

    def integral(values: np.ndarray) -> Reference:
        return optical_thickness(replace(grid, sigma_t=values), RAY)

    def ratio_variance() -> Reference:
        squared, through = integral(grid.sigma_t**2 / high), transmittance(grid, RAY)
        value = through.value**2 * np.expm1(squared.value)
        return Reference(value, 1e-13 * value, "T^2 (exp(V) - 1), V = int sigma^2/majorant", NOVAK)

    def analog_look_ups() -> Reference:
        """The integral of majorant times T: what a medium of that emission and no scattering would radiate."""
        return emitted_radiance(replace(grid, emission=high / grid.sigma_t), RAY)

    def case(kind: str, title: str, make: Any, variance: Any, cost: Any, error: str, twin: Any) -> EstimatorCase:
        return EstimatorCase(
            name=f"tracking/blocks/{kind}",
            title=title,
            make=lambda: make(grid, RAY, bound),
            reference=lambda: transmittance(grid, RAY),
            variance=variance,
            cost=cost,
            oracle="transmittance, optical_thickness, emitted_radiance",
            source=f"{WALK}; {WOODCOCK if make is DeltaTransmittance else NOVAK}",
            twin=Twin(error, twin),
        )

    def global_bound(rng: np.random.Generator, n: int) -> Draws:
        return DeltaTransmittance(grid, RAY).draw(rng, n)

    def half_the_blocks(rng: np.random.Generator, n: int) -> Draws:
        near = RatioTransmittance(grid, Ray(RAY.origin, RAY.direction, 0.875), bound).draw(rng, n)
        return near._replace(value=np.asarray(near.value) ** 2)

    return [
        case(
            "delta",
            "Delta tracking, majorant in blocks of voxels",
            DeltaTransmittance,
            lambda: transmittance_variance(grid, RAY, "delta"),
            analog_look_ups,
            "the blocks are ignored: right, at the cost of the whole grid's majorant",
            lambda: Drawn(global_bound),
        ),
        case(
            "ratio",
            "Ratio tracking, majorant in blocks of voxels",
            RatioTransmittance,
            ratio_variance,
            lambda: integral(high),
            "the second half of the ray is taken to be like the first",
            lambda: Drawn(half_the_blocks),
        ),
    ]
