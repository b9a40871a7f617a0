"""Single scattering by marching along the ray, decoupled or jittered."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import (
    single_scattering,
)
from fogproof.catalogue.airlight.scenes import (
    POINT,
    RAY,
    cloud,
    fog,
)
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.contracts import Draws
from fogproof.estimators import (
    DecoupledAirlight,
    LitMedium,
    MarchedAirlight,
)
from fogproof.scene import (
    AnyMedium,
    Ray,
    Rayleigh,
)


def _march_with_a_term_more() -> Drawn:
    """N + 1 terms with a step of length / N, as printed."""
    lit, steps = LitMedium(fog(Rayleigh()), RAY, POINT), 8
    step = lit.length / steps

    def draw(rng: np.random.Generator, n: int) -> Draws:
        value = np.zeros(n)
        for k in range(steps + 1):
            t = step * (k + rng.random(n))
            value += step * lit.seen(t) * lit.scattered(t, rng)[0]
        return Draws(value, cost=np.full(n, float(steps)))

    return Drawn(draw)


def _decoupled_case(
    name: str, title: str, medium: AnyMedium, step: float, error: str, twin: Callable[[], Any], **more: Any
) -> EstimatorCase:
    ray = Ray((0.05, 0.03, -3.0), (0.0, 0.0, 1.0), 6.0)
    return EstimatorCase(
        name=f"airlight/decoupled/{name}",
        title=f"Airlight, decoupled marching, {title}",
        make=lambda: DecoupledAirlight(medium, ray, POINT, step, **more),
        reference=lambda: single_scattering(medium, ray, POINT),
        oracle="single_scattering",
        source="Kulla & Fajardo 2012",
        twin=Twin(error, twin),
        samples=300_000,
    )


def _halved(estimator: Any) -> Drawn:
    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = estimator.draw(rng, n)
        return draws._replace(value=0.5 * np.asarray(draws.value))

    return Drawn(draw)


def cases() -> list[EstimatorCase]:
    """Return the cases of marches."""
    rayleigh = fog(Rayleigh())
    through = Ray((0.05, 0.03, -3.0), (0.0, 0.0, 1.0), 6.0)
    return [
        _decoupled_case(
            name="homogeneous",
            title="homogeneous fog, three steps",
            medium=rayleigh,
            step=2.0,
            error="the density is the sum of both, not the mean",
            twin=lambda: _halved(DecoupledAirlight(rayleigh, through, POINT, 2.0)),
        ),
        _decoupled_case(
            name="voxels",
            title="cloud of voxels, steps of a centimetre",
            medium=cloud(),
            step=0.01,
            error="two steps through the whole cloud",
            twin=lambda: DecoupledAirlight(cloud(), through, POINT, 2.25),
        ),
        _decoupled_case(
            name="voxels/ratio",
            title="cloud of voxels, shadow rays by ratio tracking",
            medium=cloud(),
            step=0.01,
            error="the axes of the grid are exchanged",
            twin=lambda: DecoupledAirlight(cloud(turned=True), through, POINT, 0.01, shadow_rays="ratio"),
            shadow_rays="ratio",
        ),
        EstimatorCase(
            name="airlight/march/jittered",
            title="Airlight, marching with a jittered place in each of 8 steps",
            make=lambda: MarchedAirlight(rayleigh, RAY, POINT, 8, "jittered"),
            reference=lambda: single_scattering(rayleigh, RAY, POINT),
            cost=lambda: 8.0,
            oracle="single_scattering",
            source="stratified sampling of the Riemann sum",
            twin=Twin("N + 1 terms with a step of length / N", _march_with_a_term_more),
            samples=100_000,
        ),
    ]
