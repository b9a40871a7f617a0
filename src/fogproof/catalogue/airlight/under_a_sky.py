"""Single scattering of light from all directions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import (
    single_scattering,
)
from fogproof.catalogue.airlight.scenes import (
    BALL,
    GROUND,
    RAY,
    fog,
)
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.contracts import Draws
from fogproof.estimators import (
    EnvironmentAirlight,
    LitMedium,
    placer,
)
from fogproof.scene import (
    HenyeyGreenstein,
    Isotropic,
    Medium,
    Rayleigh,
)
from fogproof.scene.lights import Environment


def _environment_case(
    name: str, title: str, medium: Medium, shape: Any, error: str, twin: Callable[[], Any], **more: Any
) -> EstimatorCase:
    sky = Environment(1.3)
    return EstimatorCase(
        name=f"airlight/environment/{name}",
        title=f"Airlight of an environment, {title}",
        make=lambda: EnvironmentAirlight(medium, RAY, sky, shape, **more),
        reference=lambda: single_scattering(medium, RAY, sky, shape=shape),
        oracle="single_scattering",
        cost=lambda: float(more.get("directions", 1)),
        source="volume rendering equation, M directions from a density",
        twin=Twin(error, twin),
        samples=300_000,
    )


def _without_its_weight(medium: Medium, shape: Any, directions: int) -> EnvironmentAirlight:
    """Isotropic directions whose weight f/p is taken for 1: those of a medium that scatters isotropically."""
    return EnvironmentAirlight(Medium(medium.sigma_a, medium.sigma_s), RAY, Environment(1.3), shape, directions)


def _along_the_ray(medium: Medium, shape: Any) -> Drawn:
    """The radiance is looked up along the camera ray, not along the direction drawn."""
    lit = LitMedium(medium, RAY, Environment(1.3), (), shape)
    places = placer(lit, "distance")

    def draw(rng: np.random.Generator, n: int) -> Draws:
        drawn = places.sample(rng.random((n, 1)))
        ahead = np.broadcast_to(RAY.direction[:, None], (3, n))
        arriving = 1.3 * lit.transmittance(lit.points(drawn.x), ahead, np.full(n, np.inf), rng)[0]
        value = lit.seen(drawn.x) * lit.albedo * lit.extinction.sigma(drawn.x) * arriving / drawn.pdf
        return Draws(value, cost=np.ones(n))

    return Drawn(draw)


def _not_divided(estimator: EnvironmentAirlight) -> Drawn:
    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = estimator.draw(rng, n)
        return draws._replace(value=estimator.directions * np.asarray(draws.value))

    return Drawn(draw)


def cases() -> list[EstimatorCase]:
    """Return the cases of an environment."""
    forward = fog(HenyeyGreenstein(0.6))
    rayleigh = fog(Rayleigh())
    return [
        _environment_case(
            name="ball",
            title="ball of fog, directions by the phase function",
            medium=forward,
            shape=BALL,
            error="the light is looked up along the camera ray, not along the direction drawn",
            twin=lambda: _along_the_ray(forward, BALL),
        ),
        _environment_case(
            name="four-directions",
            title="ball of fog, four directions at each place",
            medium=rayleigh,
            shape=BALL,
            error="the sum over the directions is not divided by their number",
            twin=lambda: _not_divided(EnvironmentAirlight(rayleigh, RAY, Environment(1.3), BALL, 4)),
            directions=4,
        ),
        _environment_case(
            name="uniform",
            title="half-space of fog, two isotropic directions with weights",
            medium=forward,
            shape=GROUND,
            error="the weight of an isotropic direction is taken for 1",
            twin=lambda: _without_its_weight(forward, GROUND, 2),
            directions=2,
            proposal=Isotropic(),
        ),
    ]
