"""Invariant: cones, shadows and shapes change the airlight by exactly what they take away: |value - truth| <= error, where
the truth asks every point whether it is lit (`lit_truth`), and limits of one light are another.
"""

import json
import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from lit_truth import from_direction, from_point
from media_truth import within

from fogproof.analytic import single_scattering
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.oracle import answer_text
from fogproof.scene import HenyeyGreenstein, Isotropic, LinearMedium, Medium, PointLight, Ray, Rayleigh, Tabulated
from fogproof.scene.lights import DirectionalLight, Environment, SpotLight
from fogproof.scene.occluders import Disk, Sphere
from fogproof.scene.shapes import Ball, Box, HalfSpace, Slab

# The truth finds edges by looking at places with 28 digits: chords of 1e-30 m, as coordinates of 1e-246 make them, are beyond it.
coordinate = st.floats(-2, 2).map(lambda x: x if abs(x) > 1e-9 else 0.0)
point = st.tuples(coordinate, coordinate, coordinate)
unit = point.filter(lambda v: math.hypot(*v) > 0.2).map(lambda v: tuple(x / math.hypot(*v) for x in v))
phases = st.sampled_from([Isotropic(), Rayleigh(), HenyeyGreenstein(0.7), HenyeyGreenstein(-0.9)])
media = st.builds(Medium, st.floats(0, 1), st.floats(0.01, 1), phases)
spots = st.builds(
    SpotLight, point, unit, st.just(2.0), st.floats(0.05, 1.5), st.none(), st.sampled_from([0, 1, 20])
) | st.floats(0.05, 1.5).flatmap(
    lambda angle: st.builds(
        SpotLight, point, unit, st.just(2.0), st.just(angle), st.floats(0, angle - 0.02), st.sampled_from([0, 3])
    )
)
occluders = st.builds(Sphere, point, st.floats(0.05, 1)) | st.builds(Disk, point, unit, st.floats(0.05, 1))
rays = st.builds(lambda o, d, length: Ray(o, d, length), point, unit, st.floats(0.5, 8))
shapes = st.one_of(
    st.builds(Ball, point, st.floats(0.5, 3)),
    st.builds(HalfSpace, point, unit),
    st.builds(Slab, point, unit, st.floats(0.3, 4)),
    st.builds(
        lambda c, size: Box(
            tuple(x - s for x, s in zip(c, size, strict=True)), tuple(x + s for x, s in zip(c, size, strict=True))
        ),
        point,
        st.tuples(*[st.floats(0.3, 2)] * 3),
    ),
)


def well_apart(ray, light):
    """The truth integrates over the angle at the light: keep the ray off it."""
    q = np.array(light.position) - ray.origin
    return np.linalg.norm(np.cross(q, ray.direction)) > 0.02


@given(media, rays, spots)
@settings(max_examples=25, deadline=None)
def test_spot_lights(medium, ray, light):
    assume(well_apart(ray, light))
    reference = single_scattering(medium, ray, light)
    within(reference, from_point(medium, ray, light))


@given(media, rays, point, st.lists(occluders, min_size=1, max_size=2))
@settings(max_examples=25, deadline=None)
def test_shadows_of_a_point_light(medium, ray, position, things):
    light = PointLight(position, 2.0)
    assume(well_apart(ray, light))
    within(single_scattering(medium, ray, light, occluders=things), from_point(medium, ray, light, things))


@given(media, rays, point, shapes)
@settings(max_examples=20, deadline=None)
def test_a_point_light_inside_a_shape(medium, ray, position, shape):
    light = PointLight(position, 2.0)
    assume(well_apart(ray, light))
    reference = single_scattering(medium, ray, light, shape=shape)
    assume("asinh" in reference.method)  # the light is inside
    within(reference, from_point(medium, ray, light, shape=shape))


@given(media, rays, unit, shapes, st.lists(occluders, max_size=1))
@settings(max_examples=30, deadline=None)
def test_parallel_light_in_a_shape(medium, ray, direction, shape, things):
    light = DirectionalLight(direction, 3.0)
    reference = single_scattering(medium, ray, light, shape=shape, occluders=things)
    assume(not 0 < reference.value < 1e-20)
    within(reference, from_direction(medium, ray, light, things, shape))


MEDIUM = Medium(0.1, 0.3, HenyeyGreenstein(0.5))
RAY = Ray([-2, 0.3, 0.1], [[1, 0, 0.0], [0.8, 0.6, 0]], [6, math.inf])


def test_a_cone_of_all_directions_is_a_point_light():
    position, down = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)
    everywhere = single_scattering(MEDIUM, RAY, SpotLight(position, down, 2.0, math.pi))
    np.testing.assert_allclose(
        everywhere.value, single_scattering(MEDIUM, RAY, PointLight(position, 2.0)).value, rtol=1e-15
    )


def test_two_half_cones_are_a_point_light():
    """Any axis: what the one does not light, the other does; the error of the common edge is counted in both."""
    position, axis = (0.0, 0.0, 1.0), (0.6, 0.0, -0.8)
    one, other = (
        single_scattering(MEDIUM, RAY, SpotLight(position, tuple(sign * x for x in axis), 2.0, angle))
        for sign, angle in ((1, 1.0), (-1, math.pi - 1.0))
    )
    whole = single_scattering(MEDIUM, RAY, PointLight(position, 2.0))
    assert np.all(np.abs(one.value + other.value - whole.value) <= one.error + other.error + whole.error)
    assert np.all(one.error + other.error <= 1e-11 * whole.value)


def test_the_spot_light_on_the_ray_is_infinite_only_where_it_shines():
    ray = Ray([0, 0, 0], [0, 0, 1.0], 5.0)
    for axis in ((0.0, 0.0, 1.0), (0.0, 0.0, -1.0)):
        assert single_scattering(MEDIUM, ray, SpotLight((0, 0, 3.0), axis, 1.0, 0.5)).value == np.inf
    assert single_scattering(MEDIUM, ray, SpotLight((0, 0, 3.0), (1.0, 0.0, 0.0), 1.0, 0.5)).value == 0


def test_a_light_inside_an_occluder_is_dark():
    dark = single_scattering(MEDIUM, RAY, PointLight((0, 0, 1.0), 2.0), occluders=[Sphere((0, 0, 1.1), 0.5)])
    assert np.all(dark.value == 0)


def test_shadows_work_with_tables_channels_and_other_methods():
    light, ball = PointLight((0, 0, 1.0), (2.0, 1.0)), [Sphere((0, 0.3, 0.5), 0.2)]
    table = Tabulated.normalised((-1, 0, 1), (1, 0.5, 2))
    both = single_scattering(Medium(0.1, (0.3, 0.6), table), RAY, light, occluders=ball)
    assert both.value.shape == (2, 2)
    for channel, (sigma_s, intensity) in enumerate([(0.3, 2.0), (0.6, 1.0)]):
        one = single_scattering(Medium(0.1, sigma_s, table), RAY, PointLight((0, 0, 1.0), intensity), occluders=ball)
        np.testing.assert_allclose(both.value[:, channel], one.value, rtol=1e-14)
    grey = Medium(0.1, 0.3)
    exact = single_scattering(grey, RAY, light, occluders=ball)
    other = single_scattering(grey, RAY, light, occluders=ball, method="equiangular")
    assert np.all(np.abs(exact.value - other.value) <= exact.error + other.error)


def test_the_sun_is_a_light_far_away():
    """A point light at distance D with irradiance E here has the intensity E D^2; its way through vacuum costs nothing."""
    box, direction = Box((-3, -3, -3), (3, 3, 3)), np.array([0.6, 0.0, -0.8])
    sun = single_scattering(MEDIUM, RAY, DirectionalLight(tuple(direction), 1.0), shape=box)
    D = 1e7
    lamp = PointLight(tuple((-D * direction).tolist()), D * D)
    near = Ray(RAY.origin, RAY.direction, [6.0, 20.0])
    np.testing.assert_allclose(single_scattering(MEDIUM, near, lamp, shape=box).value, sun.value, rtol=3e-6)


def test_unbounded_media_get_nothing_from_outside():
    for light in (DirectionalLight((0, 0, -1.0), 2.0), Environment(1.0)):
        reference = single_scattering(MEDIUM, RAY, light)
        assert np.all(reference.value == 0)
        assert np.all(reference.error == 0)


def test_shapes_and_lights_come_from_requests():
    request = {
        "quantity": "single_scattering",
        "medium": {"sigma_a": 0.1, "sigma_s": 0.3},
        "ray": {"origin": [0, 0, -1], "direction": [0, 0, -1], "length": "inf"},
        "light": {"kind": "directional", "direction": [0, 0.6, -0.8], "irradiance": 2},
        "shape": {"kind": "half-space", "point": [0, 0, 0], "normal": [0, 0, 1]},
        "occluders": [{"kind": "sphere", "center": [0, 3, 1], "radius": 0.1}],
    }
    answer = answer_text(json.dumps(request))
    sigma_t, f = 0.4, 1 / (4 * math.pi)  # exp(-sigma t) on the way out, exp(-sigma (1 + t)/0.8) on the way in
    assert answer["value"] == pytest.approx(
        0.3 * 2 * f * math.exp(-sigma_t / 0.8) / (sigma_t * (1 + 1 / 0.8)), rel=1e-13
    )


def expint2(x):
    return mp.expint(2, abs(x))


@pytest.mark.parametrize("thickness", [0.5, 5.0])
def test_environment_around_a_slab(thickness):
    """Isotropic: the radiance received at depth z is E_2(sigma z)/2 from each side."""
    ray = Ray([0, 0, 0], [0.6, 0, -0.8])
    reference = single_scattering(
        Medium(0.1, 0.3), ray, Environment(1.0), shape=Slab((0, 0, 0), (0, 0, 1.0), thickness)
    )
    s, c, H = mp.mpf(0.1) + mp.mpf(0.3), mp.mpf(0.8), mp.mpf(thickness)
    with mp.workdps(20):
        received = mp.quad(
            lambda t: mp.exp(-s * t) * (expint2(s * c * t) + expint2(s * (H - c * t))) / 2, [0, H / c / 2, H / c]
        )
        within(reference, mp.mpf(0.3) * received)
    assert reference.error <= 1e-6 * reference.value


@pytest.mark.parametrize("depth", [0.0, 1.0])
def test_environment_around_a_half_space(depth):
    ray = Ray([0, 0, -depth], [0, 0, -1.0])
    reference = single_scattering(Medium(0.1, 0.3), ray, Environment(2.0), shape=HalfSpace((0, 0, 0), (0, 0, 1.0)))
    s = mp.mpf(0.1) + mp.mpf(0.3)
    with mp.workdps(20):
        received = mp.quad(lambda t: mp.exp(-s * t) * expint2(s * (depth + t)) / 2, [0, 1, 5, 20, 120])
        within(reference, 2 * mp.mpf(0.3) * received)


def test_environment_around_a_ball():
    ray = Ray([0.7, 0, -5], [0, 0, 1.0])
    reference = single_scattering(Medium(0.1, 0.3), ray, Environment(1.0), shape=Ball((0, 0, 0), 1.0))
    s = mp.mpf(0.1) + mp.mpf(0.3)
    with mp.workdps(15):
        half = mp.sqrt(1 - mp.mpf(0.7) ** 2)

        def received(t):
            q = mp.sqrt(mp.mpf(0.7) ** 2 + t * t)
            way = lambda mu: q * mu + mp.sqrt(1 - q * q * (1 - mu * mu))  # noqa: E731
            return mp.quad(lambda mu: mp.exp(-s * way(mu)), [-1, -0.2, 0, 0.2, 1]) / 2

        within(reference, mp.mpf(0.3) * mp.quad(lambda t: mp.exp(-s * (t + half)) * received(t), [-half, 0, half]))
    assert reference.error <= 1e-9 * reference.value


@pytest.mark.parametrize("shape", [Ball((0, 0, 0), 1.0), Slab((0, 0, 1), (0, 0, 1.0), 2.0)])
def test_environment_of_other_phase_functions_agrees_with_isotropic_in_the_limit(shape):
    """g -> 0 takes the rules in two angles, isotropic the rule in one: two ways to the same number."""
    ray = Ray([0.4, 0, -0.3], [0.6, 0, 0.8])
    one = single_scattering(Medium(0.1, 0.3), ray, Environment(1.0), shape=shape)
    two = single_scattering(Medium(0.1, 0.3, HenyeyGreenstein(1e-15)), ray, Environment(1.0), shape=shape)
    assert abs(one.value - two.value) <= one.error + two.error
    assert two.error <= 1e-6 * two.value


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (
            {"light": Environment(1.0), "shape": Ball((0, 0, 0), 2.0), "occluders": [Sphere((0, 0, 0), 1.0)]},
            "occluders before",
        ),
        ({"light": SpotLight((0, 0, 1.0), (0, 0, -1.0), 1.0, 1.0, 0.5), "method": "equiangular"}, "fall-off"),
        ({"medium": LinearMedium(1.0, (0, 0, 0.1)), "shape": Ball((0, 0, 0), 1.0)}, "bounds of its own"),
    ],
)
def test_refusals(arguments, reason):
    with pytest.raises(UnsupportedError, match=reason):
        single_scattering(**({"medium": MEDIUM, "ray": RAY, "light": PointLight((0, 0, 1.0), 1.0)} | arguments))


@pytest.mark.parametrize(
    ("build", "argument", "got"),
    [
        (lambda: SpotLight((0, 0, 0), (0, 0, 2.0), 1.0, 1.0), "direction", "2.0"),
        (lambda: SpotLight((0, 0, 0), (0, 0, 1.0), 1.0, 4.0), "half_angle", "4.0"),
        (lambda: SpotLight((0, 0, 0), (0, 0, 1.0), 1.0, 0.0), "half_angle", "0.0"),
        (lambda: SpotLight((0, 0, 0), (0, 0, 1.0), 1.0, 1.0, 1.5), "falloff_start", "1.5"),
        (lambda: SpotLight((0, 0, 0), (0, 0, 1.0), 1.0, 1.0, exponent=0.5), "exponent", "0.5"),
        (lambda: SpotLight((0, 0, 0), (0, 0, 1.0), 1.0, 2.0, exponent=2), "half_angle", "2.0"),
        (lambda: DirectionalLight((0, 0, 1.0), -1.0), "irradiance", "-1.0"),
        (lambda: DirectionalLight([[0, 0, 1.0]], 1.0), "direction", "[[0, 0, 1.0]]"),
        (lambda: Environment(math.nan), "radiance", "nan"),
        (lambda: Sphere((0, 0), 1.0), "center", "2"),
        (lambda: Sphere((0, 0, 0), 0.0), "radius", "0.0"),
        (lambda: Disk((0, 0, 0), (1.0, 1.0, 0), 1.0), "normal", "1.414"),
        (lambda: Ball((0, 0, 0), -1.0), "radius", "-1.0"),
        (lambda: Slab((0, 0, 0), (0, 0, 1.0), math.inf), "thickness", "inf"),
        (lambda: Box((0, 0, 0), (1, 0, 1)), "upper", "0"),
        (lambda: single_scattering(MEDIUM, RAY, PointLight((0, 0, 1.0), 1.0), occluders=["tree"]), "occluders", "tree"),
    ],
)
def test_bad_input(build, argument, got):
    with pytest.raises(InvalidValueError) as caught:
        build()
    assert caught.value.argument == argument
    assert got in str(caught.value)


@pytest.mark.parametrize(("start", "exponent"), [(0.0, 0), (0.25, 0), (0.1, 2)])
def test_a_fall_off_that_is_linear_in_the_angle(start, exponent):
    ray = Ray([0, 0, -2.0], [0, 0, 1.0], 5.0)
    light = SpotLight((0.6, -0.8, 0.5), (-6 / 11, 9 / 11, 2 / 11), 3.0, 0.7, start, exponent, "linear")
    found = single_scattering(MEDIUM, ray, light)
    assert abs(mp.mpf(float(found.value)) - from_point(MEDIUM, ray, light)) <= found.error <= 1e-11 * found.value


def test_the_spot_of_blender():
    """Half a degree inside the edge the intensity of Cycles is smoothstep((cos - edge)/((1 - edge) blend))."""
    size, blend = math.radians(60), 0.4
    light = SpotLight.from_blender((0, 0, 0), (0, 0, 1.0), 1.0, size, blend)
    edge = math.cos(size / 2)
    assert math.cos(light.falloff_start) == pytest.approx(edge + blend * (1 - edge))
    assert SpotLight.from_blender((0, 0, 0), (0, 0, 1.0), 1.0, size, 0.0).falloff_start == pytest.approx(
        light.half_angle
    )
    with pytest.raises(InvalidValueError, match="blend"):
        SpotLight.from_blender((0, 0, 0), (0, 0, 1.0), 1.0, size, 1.5)
    with pytest.raises(InvalidValueError, match="profile"):
        SpotLight((0, 0, 0), (0, 0, 1.0), 1.0, 1.0, 0.5, profile="cubic")
