"""Estimators of the transmittance beside the trackers, in two voxels, where their mean, variance and cost are known exactly."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import voxel_estimate_cost, voxel_estimate_mean, voxel_estimate_variance
from fogproof.catalogue.cases import Case, Drawn, EstimatorCase, Twin
from fogproof.contracts import Draws
from fogproof.estimators import (
    DecompositionTransmittance,
    JitteredMarch,
    MarchedTransmittance,
    NextFlightTransmittance,
    PowerSeriesTransmittance,
    TelescopingTransmittance,
    UnbiasedMarch,
    WeightedTransmittance,
)
from fogproof.estimators.tracking.ray_looks import RayLooks
from fogproof.scene import PiecewiseConstantMedium, Ray

EDGES, SIGMA = (0.0, 1.0, 1.7), (0.5, 2.0)
VOXELS = PiecewiseConstantMedium(np.array(EDGES), SIGMA)
RAY = Ray((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), EDGES[-1])

GEORGIEV = "Bhanot & Kennedy 1985; Georgiev et al. 2019"
GALTIER = "Galtier et al. 2013"
KETTUNEN = "Kettunen, d'Eon, Pantaleoni & Novák 2021"
KUTZ = "Kutz et al. 2017"
MISSO = "Misso, Bitterli, Georgiev & Jarosz 2022"
CRAMER = "Cramer 1978; Novák, Selle & Jarosz 2014"


def _case(
    name: str,
    title: str,
    estimate: str,
    make: Callable[[], Any],
    source: str,
    error: str,
    twin: Any,
    *,
    known_cost: bool = True,
    **options: Any,
) -> EstimatorCase:
    """Return a case in two voxels; where the variance of the cost is infinite, its mean cannot be tested."""
    arguments: dict[str, Any] = {"sigma": SIGMA, "length": np.diff(EDGES), "estimate": estimate, **options}
    return EstimatorCase(
        name=f"tracking/{name}",
        title=f"{title}, two voxels",
        make=make,
        reference=lambda: voxel_estimate_mean(**arguments),
        variance=lambda: voxel_estimate_variance(**arguments),
        cost=(lambda: voxel_estimate_cost(**arguments)) if known_cost else None,
        oracle="voxel_estimate_mean, voxel_estimate_variance, voxel_estimate_cost",
        source=source,
        twin=Twin(error, twin),
        samples=500_000,
    )


def _altered(estimator: Any, change: Callable[[np.ndarray], np.ndarray]) -> Callable[[], Drawn]:
    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = estimator.draw(rng, n)
        return draws._replace(value=change(np.asarray(draws.value)))

    return lambda: Drawn(draw)


def _never_divided(points: int) -> Callable[[], Drawn]:
    """Order 2 in one case of ten, whose terms are not divided by that probability."""
    along = RayLooks(VOXELS, RAY)

    def draw(rng: np.random.Generator, n: int) -> Draws:
        X = -along.combs(rng, 3 * n, points).reshape(n, 3)
        x, y, z = X[:, :1], X[:, 1:2] - X[:, :1], X[:, 2:] - X[:, :1]
        longer = rng.random((n, 1)) < 0.1
        value = np.exp(x) * (1 + longer * ((y + z) / 2 + y * z / 2))
        return Draws(value[:, 0], points * np.where(longer[:, 0], 3.0, 1.0))

    return lambda: Drawn(draw)


def _one_difference(points: int) -> Callable[[], Drawn]:
    """The first difference always, and no other: the bias is that of a march twice as fine."""
    along = RayLooks(VOXELS, RAY)

    def draw(rng: np.random.Generator, n: int) -> Draws:
        return Draws(np.exp(-along.depth(rng.random(n), 2 * points)), np.full(n, 3.0 * points))

    return lambda: Drawn(draw)


def cases() -> list[Case]:
    """Return the cases of these estimators."""
    small = "the majorant bounds one voxel of two"
    weighted, flights = WeightedTransmittance(VOXELS, RAY, 1.7), NextFlightTransmittance(VOXELS, RAY, 2.5)
    series, decomposed = PowerSeriesTransmittance(VOXELS, RAY, 1.5, 3.0), DecompositionTransmittance(VOXELS, RAY, 0.4)
    return [
        _case(
            "march/jittered",
            "Ray marching behind a random offset, with its bias",
            "march",
            lambda: JitteredMarch(VOXELS, RAY, 3),
            "Jensen's inequality",
            "no offset: every look is in the middle of its step",
            lambda: MarchedTransmittance(VOXELS, RAY, RAY.length / 3),
            points=3,
        ),
        _case(
            "telescoping",
            "Telescoping sum of marches",
            "telescoping",
            lambda: TelescopingTransmittance(VOXELS, RAY, 2, 0.45),
            MISSO,
            "the sum ends after the first difference",
            _one_difference(2),
            points=2,
            ratio=0.45,
            known_cost=False,
        ),
        _case(
            "unbiased-march/coarse",
            "Unbiased ray marching, one look a comb",
            "unbiased-march",
            lambda: UnbiasedMarch(VOXELS, RAY, 1),
            KETTUNEN,
            "terms are not divided by the probability of being reached",
            _never_divided(1),
            points=1,
        ),
        _case(
            "unbiased-march/fine",
            "Unbiased ray marching, three looks a comb",
            "unbiased-march",
            lambda: UnbiasedMarch(VOXELS, RAY, 3),
            KETTUNEN,
            "the series is left out: a march behind a random offset",
            lambda: JitteredMarch(VOXELS, RAY, 3),
            points=3,
        ),
        _case(
            "power-series",
            "Power series around a pivot that bounds neither looks nor depth",
            "power-series",
            lambda: series,
            GEORGIEV,
            "the exponential of the pivot is forgotten for a tenth of it",
            _altered(series, lambda value: value * np.exp(0.1 * 1.5)),
            pivot=1.5,
            reach=3.0,
        ),
        _case(
            "weighted",
            f"Weighted tracking, {small}",
            "weighted",
            lambda: weighted,
            GALTIER,
            "the sign of null collisions with a negative coefficient is lost",
            _altered(weighted, np.abs),
            majorant=1.7,
        ),
        _case(
            "decomposition",
            "Decomposition tracking",
            "decomposition",
            lambda: decomposed,
            KUTZ,
            "the control part counts as if the ray were one metre long",
            _altered(decomposed, lambda value: value * np.exp(0.4 * 0.7)),
            control=0.4,
        ),
        _case(
            "next-flight",
            "Next-flight estimator",
            "next-flight",
            lambda: flights,
            CRAMER,
            "the flight from the start of the ray is not scored",
            _altered(flights, lambda value: value - np.exp(-2.5 * EDGES[-1])),
            majorant=2.5,
        ),
    ]
