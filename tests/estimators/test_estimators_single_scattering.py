"""Invariant: what single-scattering estimators are made of is right by itself (lights, shadows, shapes, shadow rays), marching
has the bias its rule says and no other, and scenes that cannot be served are refused in words.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fogproof.analytic import single_scattering, transmittance
from fogproof.analytic.geometry.convex_shapes import contains
from fogproof.analytic.geometry.convex_shapes import through as oracle_through
from fogproof.analytic.geometry.flat_rays import blocks_of
from fogproof.analytic.geometry.shadows import shadow_of_direction, shadow_of_point
from fogproof.errors import FogproofError, InvalidValueError, UnsupportedError
from fogproof.estimators import (
    Airlight,
    DecoupledAirlight,
    EnvironmentAirlight,
    LitMedium,
    MarchedAirlight,
    placer,
    shadow_transmittance,
)
from fogproof.estimators.airlight.occlusion import lit
from fogproof.estimators.airlight.shadow_rays import by_marching
from fogproof.estimators.airlight.shapes import through
from fogproof.scene import ExponentialMedium, HenyeyGreenstein, LinearMedium, Medium, PointLight, Ray, VoxelGrid
from fogproof.scene.lights import DirectionalLight, Environment, SpotLight
from fogproof.scene.occluders import Disk, Sphere
from fogproof.scene.shapes import Ball, Box, HalfSpace, Slab, Unbounded

RAY = Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0), 5.0)
ENDLESS = Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0))
LIGHT = PointLight((0.6, -0.8, 0.5), 3.0)
FOG = Medium(0.1, 0.4, HenyeyGreenstein(0.6))
RISING = LinearMedium(0.3, (0.02, 0.05, 0.1), 0.7)
AIR = ExponentialMedium(0.4, (0.1, -0.2, -0.3), 0.8)
GRID = VoxelGrid(np.full((2, 2, 2), 0.5), (-1, -1, -1), (1, 1, 1), albedo=0.8)
RNG = np.random.default_rng(1)

coordinates = st.floats(-3, 3)
positions = st.tuples(coordinates, coordinates, coordinates)
directions = positions.filter(lambda v: math.hypot(*v) > 0.1).map(lambda v: tuple(x / math.hypot(*v) for x in v))
radii = st.floats(0.05, 2)
occluders = st.one_of(st.builds(Sphere, positions, radii), st.builds(Disk, positions, directions, radii))
shapes = st.one_of(
    st.just(Unbounded()),
    st.builds(HalfSpace, positions, directions),
    st.builds(Slab, positions, directions, radii),
    st.builds(Ball, positions, radii),
    st.builds(
        lambda low, size: Box(low, tuple(a + b for a, b in zip(low, size, strict=True))),
        positions,
        st.tuples(*[radii] * 3),
    ),
)


@given(
    occluders,
    positions,
    directions,
    st.one_of(positions.map(lambda p: ("point", p)), directions.map(lambda d: ("sun", d))),
)
@settings(deadline=None)
def test_a_point_is_in_shadow_where_the_oracle_says(occluder, origin, along, light):
    kind, value = light
    if isinstance(occluder, Disk):  # which side a light in the plane of a disk is on, rounding decides
        n, c = np.asarray(occluder.normal), np.asarray(occluder.center)
        assume(abs(n @ (np.asarray(value) - c) if kind == "point" else n @ np.asarray(value)) > 1e-5)
    t = np.linspace(0, 6, 61)
    ray = Ray(origin, along, 6.0)
    (flat,) = blocks_of(ray)
    x = ray.origin[:, None] + t * ray.direction[:, None]
    if kind == "point":
        shadow = shadow_of_point(occluder, flat, value)
        towards = np.asarray(value)[:, None] - x
        distance = np.linalg.norm(towards, axis=0)
        w = towards / np.maximum(distance, 1e-300)
    else:
        shadow = shadow_of_direction(occluder, flat, value)
        distance, w = np.full(len(t), np.inf), np.broadcast_to(-np.asarray(value)[:, None], x.shape)
    start, dark, undark, end = (float(edge[0]) for edge in shadow)
    margin = 1e-6
    dark_there = (t > dark + margin) & (t < undark - margin)
    lit_there = ~((t > start - margin) & (t < end + margin))
    free = lit((occluder,), x, w, distance)
    sure = distance > margin
    if isinstance(occluder, Disk):
        sure &= np.abs(n @ (x - c[:, None])) > margin
    assert not free[dark_there & sure].any()
    assert free[lit_there & sure].all()


@given(shapes, positions, directions)
@settings(deadline=None)
def test_ways_through_shapes_are_the_oracles(shape, x, w):
    enter, leave = through(shape, np.asarray(x)[:, None], np.asarray(w)[:, None])
    first, last = oracle_through(shape, np.asarray(x), np.asarray(w))
    if leave[0] - enter[0] > 1e-6:
        assert np.allclose([enter[0], leave[0]], [first, last], rtol=1e-9, atol=1e-9)
        low, high = max(enter[0], -9), min(leave[0], 9)
        for t in np.linspace(low, high, 7)[1:-1] if high - low > 1e-3 else ():
            assert contains(shape, np.asarray(x) + t * np.asarray(w))
    else:
        assert not last - first > 1e-5


@given(
    st.one_of(
        st.builds(LinearMedium, st.floats(-1, 1), positions),
        st.builds(ExponentialMedium, st.floats(0, 2), positions),
        st.builds(Medium, st.floats(0, 2), st.just(0.0)),
    ),
    positions,
    directions,
    st.floats(1e-3, 5),
)
@settings(deadline=None)
def test_exact_shadow_rays_are_the_oracles(medium, x, w, way):
    right = transmittance(medium, Ray(x, w, way))
    got, _ = shadow_transmittance("exact", medium, np.asarray(x)[:, None], np.asarray(w)[:, None], np.array([way]))
    assert abs(got[0] - right.value) <= right.error + 1e-12 * (1 + abs(np.log(right.value + 1e-300))) * right.value


def bias(medium, steps, rule):
    """Relative bias of marching, which is all its error: nothing is random."""
    reference = single_scattering(medium, RAY, LIGHT)
    return float(MarchedAirlight(medium, RAY, LIGHT, steps, rule).draw(RNG, 1).value[0] / reference.value - 1)


@pytest.mark.parametrize("medium", [FOG, RISING, AIR], ids=["homogeneous", "linear", "exponential"])
@pytest.mark.parametrize(("rule", "order"), [("midpoint", 2), ("right", 1)])
def test_marching_has_the_order_of_its_rule(medium, rule, order):
    found = [bias(medium, steps, rule) for steps in (128, 256, 512)]
    slopes = np.log2(np.abs(found[:-1])) - np.log2(np.abs(found[1:]))
    assert np.all(np.abs(slopes - order) < 0.05), found


def test_the_right_end_costs_two_digits():
    """At 128 steps: 7.5e-3 from the right end, 6.9e-6 from the middle, in fog of optical thickness 2.5 around the light."""
    assert 5e-3 < abs(bias(FOG, 128, "right")) < 1e-2
    assert abs(bias(FOG, 128, "midpoint")) < 1e-5


def test_marched_shadow_rays_have_order_two():
    x, w = np.array([[0.1], [0.2], [-1.0]]), np.array([[0.0], [0.6], [0.8]])
    right = float(transmittance(AIR, Ray(x[:, 0], w[:, 0], 3.0)).value)
    found = [by_marching(AIR, x, w, np.array([3.0]), steps)[0][0] / right - 1 for steps in (8, 16, 32)]
    slopes = np.log2(np.abs(found[:-1])) - np.log2(np.abs(found[1:]))
    assert np.all(np.abs(slopes - 2) < 0.05), found
    straight = by_marching(RISING, x, w, np.array([3.0]), 1)[0][0]
    assert abs(straight - float(transmittance(RISING, Ray(x[:, 0], w[:, 0], 3.0)).value)) < 1e-12


def expected(estimator, lit_medium, panels=400):
    """The expectation of a decoupled estimator: the integral of cached transmittance times scattered light, by quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    edges = np.linspace(0, lit_medium.length, panels + 1)
    half = 0.5 * np.diff(edges)
    t = (edges[:-1] + half)[:, None] + half[:, None] * nodes
    f = np.exp(-estimator.cache.depth(t.ravel())) * lit_medium.scattered(t.ravel(), RNG)[0]
    return float(np.sum(half[:, None] * weights * f.reshape(t.shape)))


def test_a_cached_transmittance_has_order_two():
    right = float(single_scattering(AIR, RAY, LIGHT).value)
    setting = LitMedium(AIR, RAY, LIGHT)
    found = [expected(DecoupledAirlight(AIR, RAY, LIGHT, step), setting) / right - 1 for step in (0.25, 0.125, 0.0625)]
    slopes = np.log2(np.abs(found[:-1])) - np.log2(np.abs(found[1:]))
    assert np.all(np.abs(slopes - 2) < 0.1), found
    plain = expected(DecoupledAirlight(FOG, RAY, LIGHT, 5.0), LitMedium(FOG, RAY, LIGHT))
    assert abs(plain / float(single_scattering(FOG, RAY, LIGHT).value) - 1) < 1e-10


@pytest.mark.parametrize("placing", ["equiangular", "free-path", "distance", "uniform", "mixed"])
def test_every_placing_stays_on_the_segment(placing):
    for ray in (RAY, ENDLESS) if placing != "uniform" else (RAY,):
        setting = LitMedium(FOG, ray, LIGHT)
        u = np.array([[0.0], [5e-324], [0.5], [0.5 - 2.0**-54], [1 - 2.0**-53]])
        draw = placer(setting, placing).sample(u)
        assert np.all((draw.x >= 0) & (draw.x <= setting.length))
        assert np.all(draw.pdf > 0)


def test_a_mixed_density_is_never_less_than_half_of_either():
    setting = LitMedium(FOG, RAY, LIGHT)
    t = np.linspace(0, 5, 101)
    mixed, equiangular, distance = (placer(setting, p).pdf(t) for p in ("mixed", "equiangular", "distance"))
    assert np.allclose(mixed, 0.5 * (equiangular + distance), rtol=1e-14)


def test_what_has_no_light_is_dark():
    away = Ray((0.0, 9.0, 0.0), (0.0, 1.0, 0.0), 3.0)
    box = Box((-1, -1, -1), (1, 1, 1))
    cases = [
        Airlight(FOG, away, LIGHT, shape=box),
        Airlight(Medium(0.5, 0.0), RAY, LIGHT),
        Airlight(FOG, RAY, PointLight(LIGHT.position, 0.0)),
        Airlight(FOG, RAY, SpotLight(LIGHT.position, (0.6, -0.8, 0.0), 3.0, 0.3)),
        Airlight(FOG, RAY, DirectionalLight((1.0, 0.0, 0.0), 1.0), "distance"),
        Airlight(FOG, RAY, LIGHT, occluders=(Sphere(LIGHT.position, 0.1),)),
        EnvironmentAirlight(FOG, away, Environment(1.0), box),
        EnvironmentAirlight(FOG, RAY, Environment(1.0), Unbounded()),
    ]
    for case in cases:
        assert np.all(case.draw(RNG, 100).value == 0)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Airlight(FOG, RAY, Environment(1.0)), "EnvironmentAirlight"),
        (lambda: Airlight(FOG, RAY, DirectionalLight((1, 0, 0), 1.0)).draw(RNG, 1), "light at a point"),
        (lambda: Airlight(FOG, RAY, PointLight((0, 0, 0), 1.0)).draw(RNG, 1), "light on the ray"),
        (lambda: Airlight(FOG, ENDLESS, LIGHT, "uniform").draw(RNG, 1), "ray without end"),
        (lambda: Airlight(FOG, RAY, LIGHT, "nearest").draw(RNG, 1), "must be one of"),
        (lambda: Airlight(FOG, RAY, LIGHT, shadow_rays="guess").draw(RNG, 1), "must be one of"),
        (lambda: Airlight(GRID, RAY, LIGHT, "distance").draw(RNG, 1), "track it"),
        (lambda: Airlight(RISING, RAY, LIGHT, shape=Ball((0, 0, 0), 1)).draw(RNG, 1), "homogeneous"),
        (lambda: Airlight(Medium((0.1, 0.2), 0.3), RAY, LIGHT).draw(RNG, 1), "channels"),
        (lambda: Airlight(FOG, Ray(np.zeros((2, 3)), (0, 0, 1), 1.0), LIGHT).draw(RNG, 1), "batch"),
        (lambda: MarchedAirlight(FOG, ENDLESS, LIGHT, 8), "must end"),
        (lambda: MarchedAirlight(FOG, RAY, LIGHT, 0), "steps"),
        (lambda: MarchedAirlight(FOG, RAY, LIGHT, 8, "left"), "rule"),
        (lambda: EnvironmentAirlight(FOG, RAY, Environment(1.0), Ball((0, 0, 0), 1), 0), "directions"),
        (lambda: DecoupledAirlight(FOG, ENDLESS, LIGHT), "length"),
        (lambda: DecoupledAirlight(Medium(0.0, 0.0), RAY, LIGHT).draw(RNG, 1), "no medium"),
    ],
)
def test_what_cannot_be_served_is_refused_in_words(make, words):
    with pytest.raises(FogproofError, match=words) as caught:
        make()
    assert isinstance(caught.value, InvalidValueError | UnsupportedError)
