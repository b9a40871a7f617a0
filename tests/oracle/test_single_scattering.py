"""Invariant: airlight along rays given in space keeps |value - truth| <= error, the truth being the exact geometry of
the binary64 coordinates; it has the units and factors of the rendering equation, and the limits physics has.
"""

import math

import mpmath as mp
import numpy as np
import pytest
from airlight_truth import airlight
from hypothesis import given, settings
from hypothesis import strategies as st
from media_truth import within

from fogproof.analytic import single_scattering
from fogproof.errors import InvalidValueError
from fogproof.scene import HenyeyGreenstein, Isotropic, Medium, PointLight, Ray, Rayleigh

coordinates = st.one_of(st.floats(-20, 20), st.floats(-1e-6, 1e-6), st.sampled_from([0.0, 1.0, -3.0, 1e4]))
positions = st.tuples(coordinates, coordinates, coordinates)
coefficients = st.one_of(st.just(0.0), st.floats(-6, 1).map(lambda e: 10.0**e))
phases = st.sampled_from([Isotropic(), Rayleigh(), HenyeyGreenstein(0.9), HenyeyGreenstein(-0.5)])


def exact_geometry(origin, direction, position):
    """Return (h, a) at the working precision of mpmath, from coordinates taken exactly."""
    origin, direction, position = ([mp.mpf(float(x)) for x in v] for v in (origin, direction, position))
    size = mp.sqrt(mp.fdot(direction, direction))
    d = [x / size for x in direction]
    q = [p - o for p, o in zip(position, origin, strict=True)]
    along = mp.fdot(q, d)
    across = [x - along * y for x, y in zip(q, d, strict=True)]
    return mp.sqrt(mp.fdot(across, across)), -along


def truth(medium, ray, light):
    with mp.workdps(60):
        h, a = exact_geometry(ray.origin, ray.direction, light.position)
        sigma_t = mp.mpf(medium.sigma_a) + mp.mpf(medium.sigma_s)
        b = a + mp.mpf(float(ray.length)) if ray.length < math.inf else math.inf
        integral = airlight(sigma_t, h, a, b, medium.phase)
        return medium.sigma_s * mp.mpf(light.intensity) * integral / (4 * mp.pi)


@given(positions, positions, positions, st.one_of(st.just(math.inf), st.floats(1e-3, 1e3)), coefficients, phases)
@settings(max_examples=200, deadline=None)
def test_every_geometry(origin, towards, position, length, sigma_s, phase):
    size = math.hypot(*towards)
    if size < 1e-9 or sigma_s == 0:
        return
    ray = Ray(origin, [x / size for x in towards], length)
    medium, light = Medium(0.3 * sigma_s, sigma_s, phase), PointLight(position, 2.5)
    reference = single_scattering(medium, ray, light)
    if reference.error < math.inf and reference.value < math.inf:
        within(reference, truth(medium, ray, light))


def test_well_placed_scenes_are_accurate_to_1e_13():
    rng = np.random.default_rng(99)
    origin, position = rng.normal(size=(200, 3)), (0.5, 3.0, 0.25)
    direction = rng.normal(size=(200, 3)) * [1, 0.2, 1]
    ray = Ray(origin, direction / np.linalg.norm(direction, axis=1, keepdims=True), rng.uniform(1, 20, 200))
    reference = single_scattering(Medium(0.1, 0.2, Rayleigh()), ray, PointLight(position, 1.0))
    assert np.all(reference.error <= 1e-13 * reference.value)
    for i in range(0, 200, 40):
        one = Ray(ray.origin[i], ray.direction[i], ray.length[i])
        assert within(reference, truth(Medium(0.1, 0.2, Rayleigh()), one, PointLight(position, 1.0)), i) <= 3e-15


def test_far_away_camera_keeps_the_length_of_its_segment():
    """The light is 1e8 m away, the ray 1 mm long: a + length alone would be off by 1e-5 of the length."""
    medium, light, ray = Medium(0.0, 1e-9), PointLight((0, 5.0, 1e8), 1e16), Ray([0, 0, 0], [0, 0, 1.0], 1e-3)
    reference = single_scattering(medium, ray, light)
    assert within(reference, truth(medium, ray, light)) <= 1e-14
    assert reference.error <= 1e-13 * reference.value


def test_thick_medium_keeps_its_digits():
    """tau = 600: the rounding of sigma_a + sigma_s and of the distance alone would cost 1e-13."""
    medium, light, ray = Medium(0.1, 0.2), PointLight((0.0, 1e3, 1.7e3), 1e300), Ray([0.1, 0, 0], [0, 0, 1.0], math.inf)
    assert within(single_scattering(medium, ray, light), truth(medium, ray, light)) <= 1e-14


@pytest.mark.parametrize("scale", [2.0**500, 2.0**-500])
def test_scenes_of_any_size_are_one_scene(scale):
    """Lengths times 2^k, coefficients over 2^k, intensity times 2^2k: the same radiance, digit by digit."""
    ray = Ray([[0.1, 0.2, 0.3], [0.0, 0.0, 0.0]], [[0.6, 0.0, 0.8], [0.0, 0.0, 1.0]], [5.0, math.inf])
    position = (0.5, 1.0, 2.0)
    one = single_scattering(Medium(0.1, 0.2), ray, PointLight(position, 1.0))
    scaled = Ray(ray.origin * scale, ray.direction, ray.length * scale)
    with np.errstate(all="raise"):
        light = PointLight(tuple(x * scale for x in position), scale * scale)
        other = single_scattering(Medium(0.1 / scale, 0.2 / scale), scaled, light)
    np.testing.assert_array_equal(other.value, one.value)


@pytest.mark.parametrize("length", [3.0, 5.0, math.inf])
def test_light_on_the_ray_is_infinite(length):
    reference = single_scattering(Medium(0.1, 0.2), Ray([0, 0, 0], [0, 0, 1.0], length), PointLight((0, 0, 3.0), 1.0))
    assert reference.value == math.inf


def test_light_on_the_line_of_the_ray_but_not_on_it():
    ray = Ray([0, 0, 0], [0, 0, 1.0], 2.0)
    for z in (3.0, -3.0):
        light = PointLight((0, 0, z), 1.0)
        reference = single_scattering(Medium(0.1, 0.2, HenyeyGreenstein(0.7)), ray, light)
        within(reference, truth(Medium(0.1, 0.2, HenyeyGreenstein(0.7)), ray, light))


def test_a_medium_that_does_not_scatter_gives_nothing_even_at_the_light():
    ray, light = Ray([0, 0, 0], [0, 0, 1.0]), PointLight((0, 0, 3.0), 1.0)
    for medium in (Medium(0.0, 0.0), Medium(2.0, 0.0)):
        reference = single_scattering(medium, ray, light)
        assert (reference.value, reference.error) == (0, 0)
    dark = single_scattering(Medium(0.0, 1.0), ray, PointLight((0, 0, 3.0), 0.0))
    assert (dark.value, dark.error) == (0, 0)


def test_channels_are_the_last_axis():
    rays = Ray(np.zeros((4, 5, 3)), [0, 0, 1.0], 7.0)
    grey, red = PointLight((0, 1, 3), 2.0), PointLight((0, 1, 3), (2.0, 1.0, 0.0))
    assert single_scattering(Medium(0.1, 0.2), rays, grey).value.shape == (4, 5)
    coloured = single_scattering(Medium(0.1, (0.2, 0.5, 0.9)), rays, red)
    assert coloured.value.shape == coloured.error.shape == (4, 5, 3)
    for channel, (sigma_s, intensity) in enumerate(zip((0.2, 0.5, 0.9), (2.0, 1.0, 0.0), strict=True)):
        one = single_scattering(Medium(0.1, sigma_s), rays, PointLight((0, 1, 3), intensity))
        np.testing.assert_allclose(coloured.value[..., channel], one.value, rtol=1e-15)
    only_light = single_scattering(Medium(0.1, 0.2), Ray([0, 0, 0], [0, 0, 1.0]), red)
    assert only_light.value.shape == (3,)


def test_nearly_on_the_light_the_error_owns_up():
    """The coordinates cannot tell on which side of the light the ray passes: no digit is promised."""
    ray = Ray([0.1, 0.2, 0.3], np.array([1.0, 2.0, 3.0]) / math.sqrt(14), 50.0)
    light = PointLight(tuple((ray.origin + 7 * ray.direction).tolist()), 1.0)
    reference = single_scattering(Medium(0.1, 0.2), ray, light)
    assert reference.value > 1e12
    assert reference.error >= reference.value


@pytest.mark.parametrize(
    ("change", "argument"),
    [({"medium": "fog"}, "medium"), ({"light": "lamp"}, "light"), ({"ray": 3}, "ray"), ({"shape": "round"}, "shape")],
)
def test_bad_input_names_the_argument(change, argument):
    good = {"medium": Medium(0.0, 1.0), "ray": Ray([0, 0, 0], [0, 0, 1.0]), "light": PointLight((0, 1, 3.0), 1.0)}
    with pytest.raises(InvalidValueError, match=argument):
        single_scattering(**(good | change))
