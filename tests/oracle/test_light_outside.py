"""Invariant: light from outside of the shape that holds the medium, far coordinates, endless rays and lights all but on the ray
get a value within its error, and the error stays small.
"""

import math

import mpmath as mp
import numpy as np
import pytest
from lit_truth import from_anywhere, from_direction, from_point

from fogproof.analytic import single_scattering
from fogproof.analytic.airlight.by_quadrature import single_scattering_by_quadrature
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.scene import HenyeyGreenstein, Isotropic, Medium, PointLight, Ray, Rayleigh
from fogproof.scene.lights import DirectionalLight, Environment, SpotLight
from fogproof.scene.shapes import Ball, Box, HalfSpace, Slab

PHASES = [Isotropic(), HenyeyGreenstein(0.7), HenyeyGreenstein(-0.5), Rayleigh()]


def unit(rng):
    v = rng.standard_normal(3)
    return v / np.linalg.norm(v)


def scene(rng, kind):
    """A shape up to 1e5 m from the origin, a ray through it from up to 1e5 times its size away, a light inside or outside."""
    far, size, normal = 10.0 ** rng.choice([0, 0, 1, 3, 5]), 10.0 ** rng.uniform(-1, 1), unit(rng)
    c = unit(rng) * far * rng.random()
    low, high = c - size * rng.uniform(0.2, 1, 3), c + size * rng.uniform(0.2, 1, 3)
    shape = [
        HalfSpace(tuple(c), tuple(normal)),
        Slab(tuple(c), tuple(normal), size),
        Ball(tuple(c), size),
        Box(low, high),
    ][kind]
    inner = c - (0.3 * size * normal if kind < 2 else 0) + 0.18 * size * unit(rng)
    d, distance = unit(rng), 10.0 ** rng.uniform(-1, 1) * rng.choice([1, 1, far])
    light = PointLight(tuple(c + unit(rng) * size * 10.0 ** rng.uniform(-0.5, 1.5)), 3.0)
    sigma = 10.0 ** rng.uniform(-3, 1) / size
    medium = Medium(0.3 * sigma, 0.7 * sigma, PHASES[rng.integers(4)])
    return medium, Ray(inner - d * distance, d, distance * rng.uniform(1, 3) + size), light, shape


@pytest.mark.parametrize("kind", range(4), ids=["half space", "slab", "ball", "box"])
def test_a_hard_ensemble_of_shapes_and_lights(kind):
    seed = int(np.random.SeedSequence().generate_state(1)[0])
    rng = np.random.default_rng(seed)
    wide = []
    for _ in range(5):
        medium, ray, light, shape = scene(rng, kind)
        found, truth = single_scattering(medium, ray, light, shape=shape), from_anywhere(medium, ray, light, shape)
        off = abs(mp.mpf(float(found.value)) - truth)
        assert off <= mp.mpf(float(found.error)), (seed, medium, ray, light, shape)
        if truth > 1e-290:
            wide.append(float(found.error) / float(truth))
    assert not wide or np.median(wide) < 1e-6, (seed, wide)  # coordinates of 1e5 m are known to 1e-11 m


def test_an_endless_ray_through_a_half_space_with_the_light_outside():
    medium, shape = Medium(0.1, 0.3, HenyeyGreenstein(0.5)), HalfSpace((0, 0, 0), (0, 0, 1.0))
    light, o, d = PointLight((0.3, 0.5, 1.0), 2.0), (0.2, 0, -1.0), (0.0, 0.6, -0.8)
    endless = single_scattering(medium, Ray(o, d), light, shape=shape)
    long = from_anywhere(medium, Ray(o, d, 400.0), light, shape)
    assert abs(float(endless.value) - float(long)) <= float(endless.error) < 1e-11 * float(long)
    for other in (SpotLight((0.3, 0.5, 1.0), (0, 0, -1.0), 2.0, 1.2, 0.3), DirectionalLight((0, 0.6, -0.8), 1.0)):
        found = single_scattering(medium, Ray([o, o], d, [400.0, math.inf]), other, shape=shape)
        assert abs(found.value[0] - found.value[1]) <= found.error.sum()


@pytest.mark.parametrize("h", [1e-6, 1e-9, 1e-12, 1e-15])
def test_a_light_all_but_on_the_ray_with_coordinates_that_are_exact(h):
    medium, ray, light = (
        Medium(0.1, 0.3, HenyeyGreenstein(0.3)),
        Ray((0, 0, 0), (0, 0, 1.0), 4.0),
        PointLight((h, 0, 1.5), 2.0),
    )
    rounded, exact = single_scattering(medium, ray, light), single_scattering(medium, ray, light, exact=True)
    truth = from_point(medium, ray, light)
    assert abs(mp.mpf(float(exact.value)) - truth) <= exact.error <= 1e-12 * exact.value
    assert rounded.error > 1e3 * exact.error


def test_parallel_light_in_thick_balls_keeps_its_digits():
    rng = np.random.default_rng()
    for _ in range(6):
        radius = 10.0 ** rng.uniform(-1, 1)
        sigma = 10.0 ** rng.uniform(1, 2.7) / radius
        medium = Medium(0.3 * sigma, 0.7 * sigma)
        ray = Ray(unit(rng) * radius * rng.uniform(0, 0.6), unit(rng), radius * rng.uniform(0.1, 5))
        light, shape = DirectionalLight(tuple(unit(rng)), 1.0), Ball((0, 0, 0), radius)
        found, truth = single_scattering(medium, ray, light, shape=shape), from_direction(medium, ray, light, (), shape)
        assert abs(mp.mpf(float(found.value)) - truth) <= found.error, (ray, light, shape, medium)
        assert found.error <= 1e-9 * found.value or found.value < 1e-300, (ray, light, shape, medium)


def test_an_environment_around_a_box_has_an_answer_and_a_wide_slab_agrees():
    """A box that is very wide is a slab, for which another method knows the answer."""
    medium, ray = Medium(0.5, 1.5), Ray((0, 0, -2.0), (0, 0, 1.0))
    wide = single_scattering(medium, ray, Environment(1.0), shape=Box((-1e4, -1e4, -1), (1e4, 1e4, 0)))
    slab = single_scattering(medium, ray, Environment(1.0), shape=Slab((0, 0, 0), (0, 0, 1.0), 1.0))
    assert abs(wide.value - slab.value) <= wide.error + slab.error
    assert wide.error < 0.02 * wide.value


@pytest.mark.parametrize(
    "light", [DirectionalLight((0.6, 0, -0.8), 2.0), Environment(1.0)], ids=["parallel", "all around"]
)
def test_the_fallback_agrees_with_what_the_modules_know(light):
    medium, ray = Medium(0.3, 0.9, HenyeyGreenstein(0.4)), Ray((0.2, -0.1, -3.0), (0, 0, 1.0))
    shape = Ball((0, 0, 0), 1.0)
    known = single_scattering(medium, ray, light, shape=shape)
    flat = FlatRays(ray.origin[None], ray.direction[None], ray.length[None])
    value, error, _, _ = single_scattering_by_quadrature(medium, flat, light, shape, ())
    assert abs(float(value[0, 0]) - float(known.value)) <= float(error[0, 0]) + float(known.error)
    assert error[0, 0] < 1e-4 * value[0, 0]


def test_a_ray_in_a_face_that_parallel_light_meets_edge_on():
    """By one rounding more or less the light comes in where the ray is, or all the way through the box: the error says so."""
    box, d = Box((-1, -2, -1.5), (2, 2, 1.5)), (1.0, -7e-246, 3e-50)
    medium, ray, light = Medium(0.6, 0.3), Ray((1.0, 2.0, 1.5), d, 1.1), DirectionalLight(d, 3.0)
    found, lit = single_scattering(medium, ray, light, shape=box), from_direction(medium, ray, light, (), box)
    assert abs(float(found.value) - float(lit)) <= found.error
