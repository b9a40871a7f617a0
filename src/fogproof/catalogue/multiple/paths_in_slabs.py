"""Path tracing in a slab against the exact solutions of multiple scattering."""

from __future__ import annotations

import numpy as np

from fogproof import analytic
from fogproof.catalogue.cases import Drawn, EstimatorCase
from fogproof.catalogue.multiple.builders import (
    ABOVE,
    BELOW,
    BLACK,
    FOG,
    NEXT_EVENT,
    SKY,
    SLAB,
    SUN,
    SUNLIGHT,
    UP,
    VIEW,
    combined,
    literal,
    paths_case,
    scaled,
    times,
)
from fogproof.contracts import Draws, Reference
from fogproof.estimators import (
    PathTracer,
    Roulette,
)
from fogproof.scene import HenyeyGreenstein, Medium, Ray, Rayleigh
from fogproof.scene.surfaces import Surface


def _random_walk_variance() -> Reference:
    """A walk that weighs c^n when it leaves towards the sky: its square weighs (c^2)^n, so E[w^2] = R(c^2)."""
    first, second = analytic.slab_reflectance(0.9, 1.0, VIEW), analytic.slab_reflectance(0.9 * 0.9, 1.0, VIEW)
    return combined("R(c^2) - R(c)^2", lambda m2, m1: m2 - m1 * m1, second, first)


def _by_order(count: int) -> Reference:
    """Orders 0 … count - 1 one by one, and the rest together."""
    orders, whole = analytic.slab_reflectance_orders(1.0, VIEW, count - 1), analytic.slab_reflectance(0.9, 1.0, VIEW)
    scale = 0.9 ** np.arange(count)
    value, error = orders.value * scale, orders.error * scale
    value[0] = error[0] = 0.0  # nothing comes back unscattered
    rest = float(whole.value) - value.sum()
    return Reference(
        np.append(value, rest), np.append(error, float(whole.error) + error.sum()), orders.method, orders.source
    )


def _up_to(order: int) -> Reference:
    orders = analytic.slab_reflectance_orders(1.0, VIEW, order)
    scale = 0.9 ** np.arange(order + 1)
    return Reference(np.asarray(orders.value @ scale), np.asarray(orders.error @ scale), orders.method, orders.source)


def _shifted(tracer: PathTracer) -> Drawn:
    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = tracer.draw(rng, n)
        return draws._replace(value=np.roll(np.asarray(draws.value), 1, axis=1))

    return Drawn(draw)


def cases() -> list[EstimatorCase]:
    """Return the cases of a slab."""
    forward = Medium(0.1, 0.9, HenyeyGreenstein(0.75))
    bright = Medium(0.02, 1.98)
    glowing = Medium(0.3, 0.7, emission=2.0)
    return [
        paths_case(
            name="slab/met",
            title="Slab under a sky that paths meet, with the variance of a random walk",
            make=lambda: PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, "bsdf", roulette=None),
            reference=lambda: analytic.slab_reflectance(0.9, 1.0, VIEW),
            oracle="slab_reflectance",
            error="the batch is full when the short paths are through",
            twin=lambda: literal(spare=0.25),
            variance=_random_walk_variance,
        ),
        paths_case(
            name="slab/looked-for",
            title="Slab under a sky that collisions look for",
            make=lambda: PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, "nee", roulette=None),
            reference=lambda: analytic.slab_reflectance(0.9, 1.0, VIEW),
            oracle="slab_reflectance",
            error="light is looked for and met, and counted twice",
            twin=lambda: literal(looked_for=True, share_light=False),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="slab/both",
            title="Slab that scatters forward, the sky looked for and met, by shares",
            make=lambda: PathTracer(forward, SLAB, ABOVE, SKY, BLACK, "mis"),
            reference=lambda: analytic.slab_reflectance(0.9, 1.0, VIEW, HenyeyGreenstein(0.75)),
            oracle="slab_reflectance",
            error="directions are drawn with the opposite sign of g",
            twin=lambda: literal(medium=forward, looked_for=True, drawn=HenyeyGreenstein(-0.75)),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="slab/rayleigh",
            title="Slab of Rayleigh scattering",
            make=lambda: PathTracer(Medium(0.1, 0.9, Rayleigh()), SLAB, ABOVE, SKY, BLACK),
            reference=lambda: analytic.slab_reflectance(0.9, 1.0, VIEW, Rayleigh()),
            oracle="slab_reflectance",
            error="the albedo is applied once too often",
            twin=lambda: scaled(PathTracer(Medium(0.1, 0.9, Rayleigh()), SLAB, ABOVE, SKY, BLACK), 0.9),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="slab/roulette",
            title="Slab that absorbs little, paths ended by roulette",
            make=lambda: PathTracer(bright, SLAB, ABOVE, SKY, BLACK, roulette=Roulette(3, 0.95)),
            reference=lambda: analytic.slab_reflectance(0.99, 2.0, VIEW),
            oracle="slab_reflectance",
            error="survivors of the roulette do not weigh more",
            twin=lambda: literal(medium=bright, looked_for=True, roulette=3, compensated=False),
            source="Russian roulette: Arvo & Kirk 1990",
        ),
        paths_case(
            name="slab/deepest",
            title="Slab, no more than three scatterings",
            make=lambda: PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, deepest=3),
            reference=lambda: _up_to(3),
            oracle="slab_reflectance_orders",
            error="one bounce too many",
            twin=lambda: literal(looked_for=True, deepest=3, one_more=True),
        ),
        paths_case(
            name="slab/orders",
            title="Slab, orders one by one: none, single, double, …",
            make=lambda: PathTracer(FOG, SLAB, ABOVE, SKY, Surface(BELOW), "bsdf", columns=6, roulette=None),
            reference=lambda: _by_order(5),
            oracle="slab_reflectance_orders, slab_reflectance",
            error="an order too much is told of each",
            twin=lambda: _shifted(PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, "bsdf", columns=6, roulette=None)),
        ),
        paths_case(
            name="slab/ambient",
            title="Slab whose collisions take ambient light for what is scattered in",
            make=lambda: PathTracer(FOG, SLAB, ABOVE, None, Surface(BELOW, radiance=0.3), ambient=0.8),
            reference=lambda: analytic.ambient_fog(FOG, Ray((0.0, 0.0, 0.0), UP, 1 / VIEW), 0.8, 0.3),
            oracle="ambient_fog",
            error="ambient light is not multiplied by the albedo",
            twin=lambda: PathTracer(FOG, SLAB, ABOVE, None, Surface(BELOW, radiance=0.3), ambient=0.8 / 0.9),
            variance=lambda: analytic.ambient_fog_variance(FOG, Ray((0.0, 0.0, 0.0), UP, 1 / VIEW), 0.8, 0.3),
        ),
        paths_case(
            name="slab/background",
            title="Slab before a bright surface",
            make=lambda: PathTracer(Medium(0.13, 1.17), SLAB, ABOVE, None, Surface(BELOW, radiance=1.0)),
            reference=lambda: analytic.slab_transmittance(0.9, 1.3, VIEW),
            oracle="slab_transmittance",
            error="p(t) is taken where P(z) belongs: a density for a probability",
            twin=lambda: scaled(
                PathTracer(Medium(0.13, 1.17), SLAB, ABOVE, None, Surface(BELOW, radiance=1.0)), 1 / 1.3
            ),
        ),
        paths_case(
            name="slab/glowing",
            title="Slab that glows in the dark",
            make=lambda: PathTracer(glowing, SLAB, ABOVE),
            reference=lambda: times(analytic.slab_emissivity(0.7, 1.0, VIEW), 2.0),
            oracle="slab_emissivity",
            error="emission is counted on the way into a collision and on the way out",
            twin=lambda: literal(medium=glowing, light=None, glow_again=True),
        ),
        paths_case(
            name="slab/sun",
            title="Slab in the sun",
            make=lambda: PathTracer(FOG, SLAB, ABOVE, SUNLIGHT),
            reference=lambda: times(analytic.slab_brdf(0.9, 1.0, SUN, VIEW), SUN),
            oracle="slab_brdf",
            error="the irradiance is taken to be that of the ground: a cosine too much",
            twin=lambda: scaled(PathTracer(FOG, SLAB, ABOVE, SUNLIGHT), SUN),
            source=NEXT_EVENT,
        ),
    ]
