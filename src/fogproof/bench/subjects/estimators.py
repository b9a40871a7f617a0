"""Estimators of the same number as variance x time of the processor: what one more digit costs."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.bench.benchmark import Benchmark, Goal, Way
from fogproof.estimators import Airlight, DeltaTransmittance, RatioTransmittance
from fogproof.scene import ExponentialMedium, Medium, PointLight, Ray

N = 1 << 15
RAY = Ray((0, 0, -2), (0, 0, 1), 5.0)


def _efficiency(estimator: Any) -> Way:
    """Return drawing N realisations, in variance x time of one."""
    rng = np.random.default_rng(1)
    pilot = np.asarray(estimator.draw(rng, 8 * N).value)
    return Way(lambda: estimator.draw(rng, N), N, factor=float(pilot.var()) / float(pilot.mean()) ** 2)


def _airlight() -> dict[str, Way]:
    medium, light = Medium(0.1, 0.4), PointLight((0.6, -0.8, 0.5), 3.0)
    placings: tuple[Any, ...] = ("equiangular", "distance", "uniform")
    return {name: _efficiency(Airlight(medium, RAY, light, name)) for name in placings}


def _transmittance() -> dict[str, Way]:
    medium, ray = ExponentialMedium(2.0, (0, 0, -0.5)), Ray((0, 0, 0), (0, 0, 1), 2.0)
    return {
        "ratio tracking": _efficiency(RatioTransmittance(medium, ray)),
        "delta tracking": _efficiency(DeltaTransmittance(medium, ray)),
    }


def benchmarks() -> list[Benchmark]:
    """Return them."""
    return [
        Benchmark(
            "airlight-estimators", "Airlight by place, variance x time", "relative variance", "equiangular", _airlight,
            {"uniform": Goal(">=", 1.0)},
        ),
        Benchmark(
            "transmittance-estimators", "Transmittance, variance x time", "relative variance", "ratio tracking",
            _transmittance, {"delta tracking": Goal(">=", 1.0)},
        ),
    ]  # fmt: skip
