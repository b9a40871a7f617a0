"""Path tracing through balls and boxes against the exact solutions and furnaces."""

from __future__ import annotations

import numpy as np

from fogproof import analytic
from fogproof.catalogue.cases import Drawn, EstimatorCase
from fogproof.catalogue.multiple.builders import (
    ASIDE,
    BALL,
    BOX,
    FOG,
    NEXT_EVENT,
    SKY,
    paths_case,
)
from fogproof.catalogue.twins.paths import LiteralPaths
from fogproof.contracts import Draws
from fogproof.estimators import (
    PathTracer,
)
from fogproof.scene import HenyeyGreenstein, Medium, Rayleigh
from fogproof.scene.lights import Environment, PointLight
from fogproof.scene.occluders import Sphere
from fogproof.scene.shapes import Ball
from fogproof.scene.surfaces import Surface


def _merged(tracer: PathTracer) -> Drawn:
    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = tracer.draw(rng, n)
        none, once, *more = np.asarray(draws.value).T
        return draws._replace(value=np.stack([none + once, 0 * once, *more], axis=1))

    return Drawn(draw)


def cases() -> list[EstimatorCase]:
    """Return the cases of bodies."""
    peaked = Medium(0.0, 3.0, HenyeyGreenstein(0.99))
    mild = Medium(0.5, 2.0, HenyeyGreenstein(-0.4), emission=2.0)
    core = Surface(Sphere((0.2, 0.0, 0.0), 0.4), 0.3, radiance=1.4)
    lamp = PointLight((0.0, 2.0, 0.5), 3.0)
    blue = Medium(0.1, 0.9, Rayleigh())
    glass = Medium(0.5, 2.0, emission=2.0)
    return [
        paths_case(
            name="ball/sky",
            title="Ball under the sky, one camera ray",
            make=lambda: PathTracer(FOG, BALL, ASIDE, SKY),
            reference=lambda: analytic.ball_radiance(0.9, 1.0, 0.3),
            oracle="ball_radiance",
            error="the ball is a tenth too large",
            twin=lambda: PathTracer(FOG, Ball((0.0, 0.0, 0.0), 1.1), ASIDE, SKY),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="ball/orders",
            title="Ball under the sky, orders one by one",
            make=lambda: PathTracer(
                Medium(0.0, 1.0), BALL, ASIDE, SKY, light_sampling="nee", columns=5, deepest=4, roulette=None
            ),
            reference=lambda: analytic.ball_radiance_orders(1.0, 0.3, 4),
            oracle="ball_radiance_orders",
            error="light that was scattered once passes for light that was not",
            twin=lambda: _merged(
                PathTracer(
                    Medium(0.0, 1.0), BALL, ASIDE, SKY, light_sampling="nee", columns=5, deepest=4, roulette=None
                )
            ),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="ball/lamp",
            title="Ball of Rayleigh scattering lit by a point light outside, scattered once",
            make=lambda: PathTracer(blue, BALL, ASIDE, lamp, deepest=1),
            reference=lambda: analytic.single_scattering(blue, ASIDE, lamp, shape=BALL),
            oracle="single_scattering",
            error="extinction outside the medium: shadow rays are attenuated all the way to the light",
            twin=lambda: LiteralPaths(blue, BALL, ASIDE, lamp, looked_for=True, met=False, deepest=1, all_the_way=True),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="ball/white-furnace",
            title="White furnace: a ball of albedo 1, g = 0.99, in light from everywhere",
            make=lambda: PathTracer(peaked, BALL, ASIDE, SKY, light_sampling="bsdf", roulette=None),
            reference=lambda: analytic.white_furnace(peaked, ASIDE),
            oracle="white_furnace",
            error="paths end after three scatterings",
            twin=lambda: PathTracer(peaked, BALL, ASIDE, SKY, light_sampling="bsdf", roulette=None, deepest=3),
            variance=lambda: 0.0,
            samples=100_000,
        ),
        paths_case(
            name="box/thermal-furnace",
            title="Thermal furnace: a box with a grey sphere in it, all of one temperature",
            make=lambda: PathTracer(mild, BOX, ASIDE, Environment(2.0), core),
            reference=lambda: analytic.thermal_furnace(mild, ASIDE, 2.0),
            oracle="thermal_furnace",
            error="emission is multiplied by sigma_t, not by sigma_a",
            twin=lambda: PathTracer(
                Medium(0.5, 2.0, HenyeyGreenstein(-0.4), emission=10.0), BOX, ASIDE, Environment(2.0), core
            ),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="glass/thermal-furnace",
            title="Thermal furnace: a ball of refractive index 1.5",
            make=lambda: PathTracer(glass, BALL, ASIDE, Environment(2.0), refractive_index=1.5),
            reference=lambda: analytic.thermal_furnace(glass, ASIDE, 2.0),
            oracle="thermal_furnace",
            error="the square of the refractive index is put into what the medium emits, but not into the light from outside",
            twin=lambda: PathTracer(
                Medium(0.5, 2.0, emission=2.0 * 1.5**2), BALL, ASIDE, Environment(2.0), refractive_index=1.5
            ),
            samples=200_000,
        ),
    ]
