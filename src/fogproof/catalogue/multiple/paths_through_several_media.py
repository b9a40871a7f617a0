"""Paths through several media in one: layers, and balls in balls."""

from __future__ import annotations

import numpy as np

from fogproof.analytic import layered_brdf, single_scattering, white_furnace
from fogproof.catalogue.cases import EstimatorCase
from fogproof.catalogue.multiple.builders import NEXT_EVENT, SKY, UP, paths_case, times
from fogproof.estimators import PathTracer
from fogproof.scene import CompositeMedium, HenyeyGreenstein, Medium, Ray, Rayleigh, SlabLayer
from fogproof.scene.lights import DirectionalLight, PointLight
from fogproof.scene.shapes import Ball, Slab

LAYERS = (SlabLayer(0.5, 0.9, HenyeyGreenstein(0.4)), SlabLayer(1.0, 0.6, Rayleigh()))
FLAT = (Slab((0.0, 0.0, 0.0), UP, 1.0), Slab((0.0, 0.0, -1.0), UP, 1.0))
STACK = tuple(Medium(one.tau * (1 - one.albedo), one.tau * one.albedo, one.phase) for one in LAYERS)
SUN, VIEW = 0.8, 0.5
CORE, SHELL = Medium(0.5, 2.0, Rayleigh()), Medium(0.1, 0.4, HenyeyGreenstein(0.5))
YOLK = (Ball((0.1, 0.0, 0.0), 0.6), Ball((0.0, 0.0, 0.0), 1.0))
ACROSS = Ray((0.1, 0.2, -3.0), UP, 6.0)
LAMP = PointLight((0.0, 1.5, 0.5), 3.0)


def _egg(overlap: str) -> CompositeMedium:
    return CompositeMedium((CORE, SHELL), YOLK, overlap)  # type: ignore[arg-type]


def _through_layers(shapes: tuple[Slab, Slab]) -> PathTracer:
    eye = Ray((0.0, 0.0, 3.0), (np.sqrt(1 - VIEW * VIEW), 0.0, -VIEW))
    sun = DirectionalLight((np.sqrt(1 - SUN * SUN), 0.0, -SUN), 1.0)
    return PathTracer(CompositeMedium(STACK, shapes), Slab((0.0, 0.0, 0.0), UP, 2.0), eye, sun)


def _through_egg(overlap: str) -> PathTracer:
    return PathTracer(_egg(overlap), YOLK[1], Ray(ACROSS.origin, ACROSS.direction), LAMP, deepest=1)


def cases() -> list[EstimatorCase]:
    """Return the cases of paths through several media."""
    return [
        paths_case(
            name="media/layers",
            title="Two adjacent slabs of different phase functions in the sun, all orders",
            make=lambda: _through_layers(FLAT),
            reference=lambda: times(layered_brdf(LAYERS, SUN, VIEW, np.pi), SUN),
            oracle="layered_brdf",
            error="the media are exchanged",
            twin=lambda: _through_layers((FLAT[1], FLAT[0])),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="media/overlapping",
            title="A ball in a ball whose media add up, lit by a lamp, scattered once",
            make=lambda: _through_egg("sum"),
            reference=lambda: single_scattering(_egg("sum"), Ray(ACROSS.origin, ACROSS.direction, ACROSS.length), LAMP),
            oracle="single_scattering",
            error="the first medium counts alone where both are",
            twin=lambda: _through_egg("first"),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="media/white-furnace",
            title="White furnace: two overlapping media that absorb nothing, in light from everywhere",
            make=lambda: PathTracer(_white(0.0), YOLK[1], ACROSS, SKY, light_sampling="bsdf", roulette=None),
            reference=lambda: white_furnace(Medium(0.0, 1.0), ACROSS),
            oracle="white_furnace",
            error="the outer medium absorbs",
            twin=lambda: PathTracer(_white(0.1), YOLK[1], ACROSS, SKY, light_sampling="bsdf", roulette=None),
            variance=lambda: 0.0,
            samples=100_000,
        ),
    ]


def _white(sigma_a: float) -> CompositeMedium:
    return CompositeMedium((Medium(0.0, 2.0, Rayleigh()), Medium(sigma_a, 0.4, HenyeyGreenstein(0.5))), YOLK, "sum")
