"""The case of a light with extent: one place on the ray, one direction to the light, and a twin that draws it wrongly."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fogproof.analytic import single_scattering
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.contracts import Draws
from fogproof.estimators import Airlight, LitMedium, placer
from fogproof.estimators.airlight.lighting import Sampled, sampler
from fogproof.estimators.phase.functions import phase_value
from fogproof.scene import HenyeyGreenstein, Medium, Ray
from fogproof.scene.lights import Light

FOG = Medium(0.1, 0.4, HenyeyGreenstein(0.5))
RAY = Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0), 5.0)

Alter = Callable[[Sampled, np.ndarray], Sampled]
"""(directions as they should be, points (3, n)) -> as the twin draws them."""


def extent_case(name: str, title: str, light: Light, source: str, error: str, alter: Alter) -> EstimatorCase:
    """Return the case of `Airlight` beside a light with extent, placed about it."""
    return EstimatorCase(
        name=f"airlight/{name}",
        title=f"Airlight of {title}",
        make=lambda: Airlight(FOG, RAY, light),
        reference=lambda: single_scattering(FOG, RAY, light),
        oracle="single_scattering",
        source=source,
        twin=Twin(error, lambda: _altered(light, alter)),
        samples=500_000,
    )


def _altered(light: Light, alter: Alter) -> Drawn:
    lit = LitMedium(FOG, RAY, light)
    places, sample = placer(lit, "equiangular"), sampler(light)
    assert sample is not None

    def draw(rng: np.random.Generator, n: int) -> Draws:
        drawn = places.sample(rng.random((n, 1)))
        x = lit.points(drawn.x)
        w, distance, arriving = alter(sample(x, rng.random((n, 2))), x)
        scattered = lit.albedo * lit.extinction.sigma(drawn.x) * phase_value(lit.phase, RAY.direction @ w) * arriving
        through, _ = lit.transmittance(x, w, distance, rng)
        assert drawn.pdf is not None
        return Draws(lit.seen(drawn.x) * scattered * through / drawn.pdf, np.ones(n))

    return Drawn(draw)
