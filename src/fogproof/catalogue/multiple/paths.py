"""Path tracing and random walks against the exact solutions of multiple scattering."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof import analytic
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.catalogue.twins.paths import LiteralPaths
from fogproof.contracts import Draws, Estimator, Reference
from fogproof.estimators import (
    PathTracer,
    PointSourceWalks,
    RandomFlights,
    RodWalks,
    Roulette,
    ScatteringsUnderUniformSky,
    SpectralPathTracer,
)
from fogproof.scene import HenyeyGreenstein, LinearMedium, Medium, Ray, Rayleigh, VoxelGrid
from fogproof.scene.lights import DirectionalLight, Environment, PointLight
from fogproof.scene.occluders import Sphere
from fogproof.scene.shapes import Ball, Box, HalfSpace, Slab
from fogproof.scene.surfaces import Plane, Surface

UP = (0.0, 0.0, 1.0)
SLAB = Slab((0.0, 0.0, 0.0), UP, 1.0)
BALL = Ball((0.0, 0.0, 0.0), 1.0)
BOX = Box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
BELOW = Plane((0.0, 0.0, -2.0), UP)
BLACK = Surface(BELOW)
SKY = Environment(1.0)
VIEW, SUN = 0.5, 0.8
"""Cosines to the normal of the camera ray and of the sun."""

ABOVE = Ray((0.0, 0.0, 3.0), (np.sqrt(1 - VIEW * VIEW), 0.0, -VIEW))
ASIDE = Ray((0.3, 0.0, 3.0), (0.0, 0.0, -1.0))
SUNLIGHT = DirectionalLight((np.sqrt(1 - SUN * SUN), 0.0, -SUN), 1.0)
FOG = Medium(0.1, 0.9)

_TRACING = "Kajiya & Von Herzen 1984; volume rendering equation, one-sample estimator"
_LOOKING = "next-event estimation: Coleman 1968; balance heuristic: Veach & Guibas 1995"


def _case(
    name: str,
    title: str,
    make: Callable[[], Estimator],
    reference: Callable[[], Reference],
    oracle: str,
    error: str,
    twin: Callable[[], Any],
    **more: Any,
) -> EstimatorCase:
    return EstimatorCase(
        name=f"paths/{name}",
        title=title,
        make=make,
        reference=reference,
        oracle=oracle,
        twin=Twin(error, twin),
        **{"source": _TRACING, "samples": 500_000, **more},
    )


def _scaled(estimator: Any, factor: Any) -> Drawn:
    """The subject times a factor, or with its columns weighted."""

    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = estimator.draw(rng, n)
        return draws._replace(value=np.asarray(draws.value) * factor)

    return Drawn(draw)


def _combined(method: str, formula: Callable[..., float], *parts: Reference) -> Reference:
    """A smooth formula of references; its error from moving each of them by its own, to first order and a little more."""
    values = [float(part.value) for part in parts]
    value = formula(*values)
    error = 0.0
    for i, part in enumerate(parts):
        moved = list(values)
        moved[i] += float(part.error)
        error += abs(formula(*moved) - value)
    return Reference(np.asarray(value), np.asarray(2 * error + 1e-15), method, parts[0].source)


def _times(reference: Reference, factor: Any) -> Reference:
    factor = np.asarray(factor, dtype=float)
    error = reference.error * factor + 1e-15 * np.abs(reference.value * factor)
    return Reference(reference.value * factor, error, reference.method, reference.source)


def _pair(one: Reference, two: Reference) -> Reference:
    value, error = np.array([one.value, two.value]), np.array([one.error, two.error])
    return Reference(value, error, one.method, one.source)


def _random_walk_variance() -> Reference:
    """A walk that weighs c^n when it leaves towards the sky: its square weighs (c^2)^n, so E[w^2] = R(c^2)."""
    first, second = analytic.slab_reflectance(0.9, 1.0, VIEW), analytic.slab_reflectance(0.9 * 0.9, 1.0, VIEW)
    return _combined("R(c^2) - R(c)^2", lambda m2, m1: m2 - m1 * m1, second, first)


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


def _over_lambertian(ground: float) -> Reference:
    """R + T a T_d/(1 - a R_d): the ground and the diffuse reflection of the slab from below send light back and forth."""
    parts = (
        analytic.slab_reflectance(0.9, 1.0, VIEW),
        analytic.slab_transmittance(0.9, 1.0, VIEW),
        analytic.slab_diffuse_reflectance(0.9, 1.0),
        analytic.slab_diffuse_transmittance(0.9, 1.0),
    )
    return _combined("adding", lambda R, T, Rd, Td: R + T * ground * Td / (1 - ground * Rd), *parts)


def _over_mirror() -> Reference:
    """A mirror at its lower face makes a slab look like one twice as thick, lit from both sides."""
    parts = analytic.slab_reflectance(0.9, 2.0, VIEW), analytic.slab_transmittance(0.9, 2.0, VIEW)
    return _combined("image", lambda R, T: R + T, *parts)


def _literal(**more: Any) -> LiteralPaths:
    """The plain tracer above a slab under half a sky."""
    return LiteralPaths(**{"medium": FOG, "shape": SLAB, "ray": ABOVE, "light": SKY, "horizon": UP, **more})


def cases() -> list[EstimatorCase]:
    """Return the cases of multiple scattering."""
    return [*_slabs(), *_boundaries(), *_bodies(), *_colours_and_gradients(), *_walks()]


def _slabs() -> list[EstimatorCase]:
    forward = Medium(0.1, 0.9, HenyeyGreenstein(0.75))
    bright = Medium(0.02, 1.98)
    glowing = Medium(0.3, 0.7, emission=2.0)
    return [
        _case(
            "slab/met",
            "Slab under a sky that paths meet, with the variance of a random walk",
            lambda: PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, "bsdf", roulette=None),
            lambda: analytic.slab_reflectance(0.9, 1.0, VIEW),
            "slab_reflectance",
            "the batch is full when the short paths are through",
            lambda: _literal(spare=0.25),
            variance=_random_walk_variance,
        ),
        _case(
            "slab/looked-for",
            "Slab under a sky that collisions look for",
            lambda: PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, "nee", roulette=None),
            lambda: analytic.slab_reflectance(0.9, 1.0, VIEW),
            "slab_reflectance",
            "light is looked for and met, and counted twice",
            lambda: _literal(looked_for=True, share_light=False),
            source=_LOOKING,
        ),
        _case(
            "slab/both",
            "Slab that scatters forward, the sky looked for and met, by shares",
            lambda: PathTracer(forward, SLAB, ABOVE, SKY, BLACK, "mis"),
            lambda: analytic.slab_reflectance(0.9, 1.0, VIEW, HenyeyGreenstein(0.75)),
            "slab_reflectance",
            "directions are drawn with the opposite sign of g",
            lambda: _literal(medium=forward, looked_for=True, drawn=HenyeyGreenstein(-0.75)),
            source=_LOOKING,
        ),
        _case(
            "slab/rayleigh",
            "Slab of Rayleigh scattering",
            lambda: PathTracer(Medium(0.1, 0.9, Rayleigh()), SLAB, ABOVE, SKY, BLACK),
            lambda: analytic.slab_reflectance(0.9, 1.0, VIEW, Rayleigh()),
            "slab_reflectance",
            "the albedo is applied once too often",
            lambda: _scaled(PathTracer(Medium(0.1, 0.9, Rayleigh()), SLAB, ABOVE, SKY, BLACK), 0.9),
            source=_LOOKING,
        ),
        _case(
            "slab/roulette",
            "Slab that absorbs little, paths ended by roulette",
            lambda: PathTracer(bright, SLAB, ABOVE, SKY, BLACK, roulette=Roulette(3, 0.95)),
            lambda: analytic.slab_reflectance(0.99, 2.0, VIEW),
            "slab_reflectance",
            "survivors of the roulette do not weigh more",
            lambda: _literal(medium=bright, looked_for=True, roulette=3, compensated=False),
            source="Russian roulette: Arvo & Kirk 1990",
        ),
        _case(
            "slab/deepest",
            "Slab, no more than three scatterings",
            lambda: PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, deepest=3),
            lambda: _up_to(3),
            "slab_reflectance_orders",
            "one bounce too many",
            lambda: _literal(looked_for=True, deepest=3, one_more=True),
        ),
        _case(
            "slab/orders",
            "Slab, orders one by one: none, single, double, …",
            lambda: PathTracer(FOG, SLAB, ABOVE, SKY, Surface(BELOW), "bsdf", columns=6, roulette=None),
            lambda: _by_order(5),
            "slab_reflectance_orders, slab_reflectance",
            "an order too much is told of each",
            lambda: _shifted(PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, "bsdf", columns=6, roulette=None)),
        ),
        _case(
            "slab/ambient",
            "Slab whose collisions take ambient light for what is scattered in",
            lambda: PathTracer(FOG, SLAB, ABOVE, None, Surface(BELOW, radiance=0.3), ambient=0.8),
            lambda: analytic.ambient_fog(FOG, Ray((0.0, 0.0, 0.0), UP, 1 / VIEW), 0.8, 0.3),
            "ambient_fog",
            "ambient light is not multiplied by the albedo",
            lambda: PathTracer(FOG, SLAB, ABOVE, None, Surface(BELOW, radiance=0.3), ambient=0.8 / 0.9),
            variance=lambda: analytic.ambient_fog_variance(FOG, Ray((0.0, 0.0, 0.0), UP, 1 / VIEW), 0.8, 0.3),
        ),
        _case(
            "slab/background",
            "Slab before a bright surface",
            lambda: PathTracer(Medium(0.13, 1.17), SLAB, ABOVE, None, Surface(BELOW, radiance=1.0)),
            lambda: analytic.slab_transmittance(0.9, 1.3, VIEW),
            "slab_transmittance",
            "p(t) is taken where P(z) belongs: a density for a probability",
            lambda: _scaled(PathTracer(Medium(0.13, 1.17), SLAB, ABOVE, None, Surface(BELOW, radiance=1.0)), 1 / 1.3),
        ),
        _case(
            "slab/glowing",
            "Slab that glows in the dark",
            lambda: PathTracer(glowing, SLAB, ABOVE),
            lambda: _times(analytic.slab_emissivity(0.7, 1.0, VIEW), 2.0),
            "slab_emissivity",
            "emission is counted on the way into a collision and on the way out",
            lambda: _literal(medium=glowing, light=None, glow_again=True),
        ),
        _case(
            "slab/sun",
            "Slab in the sun",
            lambda: PathTracer(FOG, SLAB, ABOVE, SUNLIGHT),
            lambda: _times(analytic.slab_brdf(0.9, 1.0, SUN, VIEW), SUN),
            "slab_brdf",
            "the irradiance is taken to be that of the ground: a cosine too much",
            lambda: _scaled(PathTracer(FOG, SLAB, ABOVE, SUNLIGHT), SUN),
            source=_LOOKING,
        ),
    ]


def _shifted(tracer: PathTracer) -> Drawn:
    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = tracer.draw(rng, n)
        return draws._replace(value=np.roll(np.asarray(draws.value), 1, axis=1))

    return Drawn(draw)


def _scattered_only(tracer: PathTracer) -> Drawn:
    return Drawn(lambda rng, n: Draws(np.asarray(tracer.draw(rng, n).value)[:, 1]))


def _merged(tracer: PathTracer) -> Drawn:
    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = tracer.draw(rng, n)
        none, once, *more = np.asarray(draws.value).T
        return draws._replace(value=np.stack([none + once, 0 * once, *more], axis=1))

    return Drawn(draw)


def _boundaries() -> list[EstimatorCase]:
    half_space, dim = HalfSpace((0.0, 0.0, 0.0), UP), Medium(0.3, 0.7)
    gray, mirror = Surface(BELOW, 0.6), Surface(Plane((0.0, 0.0, -1.0), UP), 1.0, "mirror")
    return [
        _case(
            "half-space/sky",
            "Half space under the sky",
            lambda: PathTracer(dim, half_space, ABOVE, SKY, light_sampling="bsdf"),
            lambda: analytic.half_space_reflectance(0.7, VIEW),
            "half_space_reflectance",
            "the half space ends one mean free path down",
            lambda: PathTracer(dim, SLAB, ABOVE, SKY, BLACK, light_sampling="bsdf"),
        ),
        _case(
            "half-space/sun",
            "Half space in the sun",
            lambda: PathTracer(dim, half_space, ABOVE, SUNLIGHT),
            lambda: _times(analytic.half_space_brdf(0.7, SUN, VIEW), SUN),
            "half_space_brdf",
            "the factor 1/(4 pi) of the phase function is 1/pi",
            lambda: _scaled(PathTracer(dim, half_space, ABOVE, SUNLIGHT), 4.0),
            source=_LOOKING,
        ),
        _case(
            "ground/lambert",
            "Slab over a diffuse ground",
            lambda: PathTracer(FOG, SLAB, ABOVE, SKY, gray),
            lambda: _over_lambertian(0.6),
            "slab_reflectance, slab_transmittance and their diffuse means",
            "the albedo of the ground is divided by pi twice",
            lambda: PathTracer(FOG, SLAB, ABOVE, SKY, Surface(BELOW, 0.6 / np.pi)),
            source=_LOOKING,
        ),
        _case(
            "ground/mirror",
            "Slab on a mirror",
            lambda: PathTracer(FOG, SLAB, ABOVE, SKY, mirror),
            _over_mirror,
            "slab_reflectance, slab_transmittance",
            "the mirror swallows half",
            lambda: PathTracer(FOG, SLAB, ABOVE, SKY, Surface(Plane((0.0, 0.0, -1.0), UP), 0.5, "mirror")),
            source=_LOOKING,
        ),
        _case(
            "glass/reflected",
            "Slab of refractive index 1.5 under the sky",
            lambda: PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, refractive_index=1.5),
            lambda: analytic.slab_reflectance(0.9, 1.0, VIEW, None, 1.5),
            "slab_reflectance",
            "light that the boundary reflects from outside is forgotten",
            lambda: _scattered_only(PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, refractive_index=1.5, columns=2)),
        ),
        _case(
            "glass/transmitted",
            "Slab of refractive index 1.5 before a bright surface",
            lambda: PathTracer(FOG, SLAB, ABOVE, None, Surface(BELOW, radiance=1.0), refractive_index=1.5),
            lambda: analytic.slab_transmittance(0.9, 1.0, VIEW, None, 1.5),
            "slab_transmittance",
            "radiance is divided by the square of the index on the way out, never multiplied on the way in",
            lambda: _scaled(
                PathTracer(FOG, SLAB, ABOVE, None, Surface(BELOW, radiance=1.0), refractive_index=1.5), 1 / 1.5**2
            ),
        ),
    ]


def _bodies() -> list[EstimatorCase]:
    peaked, mild = Medium(0.0, 3.0, HenyeyGreenstein(0.99)), Medium(0.5, 2.0, HenyeyGreenstein(-0.4), emission=2.0)
    core = Surface(Sphere((0.2, 0.0, 0.0), 0.4), 0.3, radiance=1.4)
    lamp, blue = PointLight((0.0, 2.0, 0.5), 3.0), Medium(0.1, 0.9, Rayleigh())
    glass = Medium(0.5, 2.0, emission=2.0)
    return [
        _case(
            "ball/sky",
            "Ball under the sky, one camera ray",
            lambda: PathTracer(FOG, BALL, ASIDE, SKY),
            lambda: analytic.ball_radiance(0.9, 1.0, 0.3),
            "ball_radiance",
            "the ball is a tenth too large",
            lambda: PathTracer(FOG, Ball((0.0, 0.0, 0.0), 1.1), ASIDE, SKY),
            source=_LOOKING,
        ),
        _case(
            "ball/orders",
            "Ball under the sky, orders one by one",
            lambda: PathTracer(
                Medium(0.0, 1.0), BALL, ASIDE, SKY, light_sampling="nee", columns=5, deepest=4, roulette=None
            ),
            lambda: analytic.ball_radiance_orders(1.0, 0.3, 4),
            "ball_radiance_orders",
            "light that was scattered once passes for light that was not",
            lambda: _merged(
                PathTracer(
                    Medium(0.0, 1.0), BALL, ASIDE, SKY, light_sampling="nee", columns=5, deepest=4, roulette=None
                )
            ),
            source=_LOOKING,
        ),
        _case(
            "ball/lamp",
            "Ball of Rayleigh scattering lit by a point light outside, scattered once",
            lambda: PathTracer(blue, BALL, ASIDE, lamp, deepest=1),
            lambda: analytic.single_scattering(blue, ASIDE, lamp, shape=BALL),
            "single_scattering",
            "extinction outside the medium: shadow rays are attenuated all the way to the light",
            lambda: LiteralPaths(blue, BALL, ASIDE, lamp, looked_for=True, met=False, deepest=1, all_the_way=True),
            source=_LOOKING,
        ),
        _case(
            "ball/white-furnace",
            "White furnace: a ball of albedo 1, g = 0.99, in light from everywhere",
            lambda: PathTracer(peaked, BALL, ASIDE, SKY, light_sampling="bsdf", roulette=None),
            lambda: analytic.white_furnace(peaked, ASIDE),
            "white_furnace",
            "paths end after three scatterings",
            lambda: PathTracer(peaked, BALL, ASIDE, SKY, light_sampling="bsdf", roulette=None, deepest=3),
            variance=lambda: 0.0,
            samples=100_000,
        ),
        _case(
            "box/thermal-furnace",
            "Thermal furnace: a box with a grey sphere in it, all of one temperature",
            lambda: PathTracer(mild, BOX, ASIDE, Environment(2.0), core),
            lambda: analytic.thermal_furnace(mild, ASIDE, 2.0),
            "thermal_furnace",
            "emission is multiplied by sigma_t, not by sigma_a",
            lambda: PathTracer(
                Medium(0.5, 2.0, HenyeyGreenstein(-0.4), emission=10.0), BOX, ASIDE, Environment(2.0), core
            ),
            source=_LOOKING,
        ),
        _case(
            "glass/thermal-furnace",
            "Thermal furnace: a ball of refractive index 1.5",
            lambda: PathTracer(glass, BALL, ASIDE, Environment(2.0), refractive_index=1.5),
            lambda: analytic.thermal_furnace(glass, ASIDE, 2.0),
            "thermal_furnace",
            "the square of the refractive index is put into what the medium emits, but not into the light from outside",
            lambda: PathTracer(
                Medium(0.5, 2.0, emission=2.0 * 1.5**2), BALL, ASIDE, Environment(2.0), refractive_index=1.5
            ),
            samples=200_000,
        ),
    ]


def _colours_and_gradients() -> list[EstimatorCase]:
    coloured = Medium((0.1, 0.2, 0.05), (0.4, 1.0, 2.0))
    thinning = LinearMedium(2.0, (0.0, 0.0, 1.8), 0.9)
    tau = 2.0 - 1.8 / 2
    sigma = np.random.default_rng(11).random((4, 5, 6)) * 3
    voxels = VoxelGrid(sigma, (-1, -1, -1), (1, 1, 1), "trilinear", 1.0, HenyeyGreenstein(0.5))
    return [
        _case(
            "slab/colours",
            "Slab of three colours, one path for all",
            lambda: SpectralPathTracer(coloured, SLAB, ABOVE, SKY, BLACK),
            lambda: analytic.slab_reflectance(coloured.albedo, coloured.sigma_t, VIEW),
            "slab_reflectance",
            "the wrong channel's pdf: that of the first, whichever was drawn",
            lambda: _literal(medium=coloured, first_channel=True),
            source="Wilkie et al. 2014, Hero wavelength spectral sampling",
        ),
        _case(
            "slab/gradient",
            "Slab that thins out downwards, by delta and ratio tracking",
            lambda: PathTracer(thinning, SLAB, ABOVE, SUNLIGHT),
            lambda: _times(analytic.slab_brdf(0.9, tau, SUN, VIEW), SUN),
            "slab_brdf",
            "the extinction at the top is taken for that of the whole slab",
            lambda: PathTracer(Medium(0.2, 1.8), SLAB, ABOVE, SUNLIGHT),
            source="Woodcock et al. 1965; Novák et al. 2014",
        ),
        _case(
            "box/voxels",
            "White furnace: a voxel grid of albedo 1",
            lambda: PathTracer(voxels, BOX, ASIDE, SKY),
            lambda: analytic.white_furnace(voxels, ASIDE),
            "white_furnace",
            "a twentieth of the scattering is lost",
            lambda: PathTracer(
                VoxelGrid(sigma, (-1, -1, -1), (1, 1, 1), "trilinear", 0.95, HenyeyGreenstein(0.5)), BOX, ASIDE, SKY
            ),
            source="Woodcock et al. 1965; Novák et al. 2014",
            samples=200_000,
        ),
    ]


def _walks() -> list[EstimatorCase]:
    lobe = HenyeyGreenstein(0.6)
    radii = (0.5, 1.0, 5.0)
    fog = Medium(0.3, 2.0, HenyeyGreenstein(0.8))
    box = Box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))

    return [
        _case(
            "walks/flights",
            "Where photons are after seven flights",
            lambda: RandomFlights(7, lobe),
            lambda: _pair(analytic.mean_displacement(7, 0.6), analytic.mean_square_displacement(7, 0.6)),
            "mean_displacement, mean_square_displacement",
            "the sign of the scattering cosine",
            lambda: RandomFlights(7, HenyeyGreenstein(-0.6)),
            source="Chandrasekhar 1943",
        ),
        _case(
            "walks/point-source",
            "Collisions around a point source in an infinite medium",
            lambda: PointSourceWalks(0.9, radii),
            lambda: analytic.point_source_collisions(0.9, np.array(radii)),
            "point_source_collisions",
            "a collision absorbs before it is counted",
            lambda: _scaled(PointSourceWalks(0.9, radii), 0.9),
            source="Case, de Hoffmann & Placzek 1953",
        ),
        _case(
            "walks/rod",
            "What comes back from a rod, and what passes it",
            lambda: RodWalks(0.9, 2.0, 0.5),
            lambda: _pair(analytic.rod_reflectance(0.9, 2.0, 0.5), analytic.rod_transmittance(0.9, 2.0, 0.5)),
            "rod_reflectance, rod_transmittance",
            "a share g goes on forwards, not (1 + g)/2",
            lambda: RodWalks(0.9, 2.0, 0.0),
            source="Schuster 1905",
        ),
        _case(
            "walks/scatterings",
            "How often light of a uniform sky scatters in a box: 4 V sigma_s / S",
            lambda: ScatteringsUnderUniformSky(fog, box),
            lambda: analytic.mean_scatterings(box, 2.0),
            "mean_scatterings",
            "absorption counts as scattering",
            lambda: ScatteringsUnderUniformSky(Medium(0.0, 2.3, HenyeyGreenstein(0.8)), box),
            source="Blanco & Fournier 2003",
        ),
    ]
