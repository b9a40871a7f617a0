"""Invariant: single scattering in any medium agrees with closed forms, with mpmath's nested quadrature of the textbook
integral, and with the same medium described in another way, each within the stated errors.
"""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lit_truth import along as point_at
from lit_truth import dot, factor, integral, minus, vector
from media_truth import within

from fogproof.analytic import single_scattering
from fogproof.errors import UnsupportedError
from fogproof.scene import (
    AnisotropicMedium,
    ExponentialMedium,
    HenyeyGreenstein,
    Isotropic,
    LinearMedium,
    Medium,
    PiecewiseConstantMedium,
    PointLight,
    Procedural,
    Ramp,
    Ray,
    Rayleigh,
    VaryingPhase,
    VoxelGrid,
)
from fogproof.scene.lights import DirectionalLight, SpotLight
from fogproof.scene.occluders import Disk, Sphere
from fogproof.scene.shapes import Box

RAY = Ray([-2, 0.3, 0.1], [[1, 0, 0.0], [0.8, 0.6, 0], [0, 0.28, 0.96]], 4.0)
CUBE = Box((-3, -3, -3), (3, 3, 3))
LIGHTS = [
    PointLight((0.1, 0.2, 1.0), 2.0),
    PointLight((0.5, 0.2, 7.0), 2.0),  # outside
    SpotLight((0, 0, 1.0), (0, 0, -1.0), 2.0, 0.9),
    SpotLight((0, 0, 1.0), (0, 0, -1.0), 2.0, 1.2, 0.3, 2),
    DirectionalLight((0, 0.6, -0.8), 2.0),
]
THINGS = [(), (Sphere((0, 0.3, 0.5), 0.2), Disk((-1, 0.5, 0.6), (0, 0, 1.0), 0.3))]


def literal(sigma_t, tau, albedo, phase, ray, light):
    """The textbook integral of a point light in mpmath, for one ray: sigma_t(x), tau(x, y), phase(x) -> f_p."""
    with mp.workdps(20):
        o, d, p = vector(ray.origin), vector(ray.direction), vector(light.position)
        foot = dot(minus(p, o), d)

        def f(t):
            x = point_at(o, d, t)
            back = minus(p, x)
            r = mp.sqrt(dot(back, back))
            f_p = factor(phase(x), -dot(minus(x, p), d) / r) / (4 * mp.pi)
            return mp.exp(-tau(o, x) - tau(x, p)) * sigma_t(x) * f_p / r**2

        length = mp.mpf(float(ray.length))
        knots = sorted({mp.mpf(0), length, *(k for k in (foot - 1, foot, foot + 1) if 0 < k < length)})
        return mp.mpf(albedo) * light.intensity * integral(f, knots)


@pytest.mark.parametrize("light", LIGHTS, ids=lambda light: type(light).__name__)
@pytest.mark.parametrize("things", THINGS, ids=["free", "shadowed"])
def test_a_constant_grid_is_a_homogeneous_box(light, things):
    medium = Medium((0.1, 0.0), (0.3, 0.5), HenyeyGreenstein(0.5))
    sigma_t, albedo = medium.sigma_t * np.ones((3, 4, 5, 1)), medium.albedo * np.ones((3, 4, 5, 1))
    grid = VoxelGrid(sigma_t, CUBE.lower, CUBE.upper, "nearest", albedo, medium.phase)
    one = single_scattering(grid, RAY, light, occluders=things)
    two = single_scattering(medium, RAY, light, occluders=things, shape=CUBE)
    assert one.value.shape == (3, 2)
    assert np.all(np.abs(one.value - two.value) <= one.error + two.error)
    assert np.all(one.error <= 1e-9 * one.value + 1e-300)


@given(st.floats(-2, 1).map(lambda e: 10.0**e), st.tuples(*[st.floats(-2, 2)] * 3), st.floats(-0.9, 0.9))
@settings(max_examples=10, deadline=None)
def test_a_linear_medium(sigma, position, g):
    gradient = (0.05 * sigma, -0.03 * sigma, 0.1 * sigma)
    medium, light = LinearMedium(sigma, gradient, 0.75, HenyeyGreenstein(g)), PointLight(position, 2.0)
    ray = Ray([-2, 0.3, 0.1], [0.8, 0.6, 0], 4.0)

    def sigma_t(x):
        return mp.mpf(sigma) + dot(vector(gradient), x)

    def tau(x, y):
        v = minus(x, y)
        return mp.sqrt(dot(v, v)) * (sigma_t(x) + sigma_t(y)) / 2

    reference = single_scattering(medium, ray, light)
    within(reference, literal(sigma_t, tau, 0.75, lambda x: HenyeyGreenstein(g), ray, light))
    assert reference.error <= 1e-8 * reference.value


def test_an_exponential_atmosphere_with_two_channels():
    medium = ExponentialMedium((0.5, 0.8), [(0, 0, -0.5), (0, 0, -2.0)], (0.9, 1.0), Rayleigh())
    ray, light = Ray([-1, 0, 0.2], [0.96, 0, 0.28], 3.0), PointLight((0.5, 0.4, 1.5), 1.0)
    reference = single_scattering(medium, ray, light)
    for channel, (s0, k, albedo) in enumerate([(0.5, -0.5, 0.9), (0.8, -2.0, 1.0)]):

        def sigma_t(x, s0=s0, k=k):
            return mp.mpf(s0) * mp.exp(k * x[2])

        def tau(x, y, sigma_t=sigma_t, k=k):
            v = minus(x, y)
            rise = y[2] - x[2]
            mean = (sigma_t(y) - sigma_t(x)) / (k * rise) if rise else sigma_t(x)
            return mp.sqrt(dot(v, v)) * mean

        within(reference, literal(sigma_t, tau, albedo, lambda x: Rayleigh(), ray, light), channel)


def test_the_sun_above_an_isothermal_atmosphere():
    """Looking straight up at the zenith sun, the thickness of both ways together is tau_0 at every height.

    So L = albedo f_p E e^(-tau_0) int sigma_t dt = albedo f_p E e^(-tau_0) tau_0 (1 - e^(-length/H)).
    """
    H, s0, albedo = 2.0, 0.4, 0.8
    medium = ExponentialMedium(s0, (0, 0, -1 / H), albedo, HenyeyGreenstein(0.5))
    reference = single_scattering(medium, Ray([0, 0, 0], [0, 0, 1.0], 30.0), DirectionalLight((0, 0, -1.0), 3.0))
    with mp.workdps(30):
        tau_0 = mp.mpf(s0) * H
        f = factor(HenyeyGreenstein(0.5), mp.mpf(1)) / (4 * mp.pi)
        within(reference, mp.mpf(albedo) * f * 3 * mp.exp(-tau_0) * tau_0 * (1 - mp.exp(-mp.mpf(30) / H)))


def test_layers():
    """A lamp in one layer, seen through another: the thickness of a way is proportional in each."""
    medium = PiecewiseConstantMedium((0.0, 1.0, 3.0), (0.8, 0.2), (0, 0, 1.0), 0.5)
    ray, light = Ray([0, 0, 0.1], [0.6, 0, 0.8], 3.0), PointLight((1.0, 0.5, 0.6), 1.0)

    def sigma_t(x):
        return mp.mpf(0.8) if x[2] < 1 else mp.mpf(0.2)

    def tau(x, y):
        v = minus(x, y)
        low, high = sorted((x[2], y[2]))
        share = (min(high, 1) - min(low, 1)) / (high - low) if high > low else mp.mpf(low < 1)
        return mp.sqrt(dot(v, v)) * (mp.mpf(0.8) * share + mp.mpf(0.2) * (1 - share))

    edge = (mp.mpf(1) - mp.mpf(0.1)) / mp.mpf(0.8)
    with mp.workdps(20):
        first = literal(sigma_t, tau, 0.5, lambda x: Isotropic(), Ray(ray.origin, ray.direction, float(edge)), light)
        both = literal_between(sigma_t, tau, ray, light, float(edge), 3.0)
    within(single_scattering(medium, ray, light), first + mp.mpf(0.5) * both)


def literal_between(sigma_t, tau, ray, light, start, end):
    o, d, p = vector(ray.origin), vector(ray.direction), vector(light.position)

    def f(t):
        x = point_at(o, d, t)
        back = minus(p, x)
        return mp.exp(-tau(o, x) - tau(x, p)) * sigma_t(x) / (4 * mp.pi) / dot(back, back)

    return integral(f, mp.linspace(mp.mpf(start), mp.mpf(end), 4))


def test_aligned_flakes():
    """Extinction depends on the direction of each way: sigma sqrt(w . S w)."""
    S = np.diag([1.0, 0.25, 0.04])
    medium = AnisotropicMedium(0.5, S, 0.6)
    ray, light = Ray([-1, 0, 0.2], [0.96, 0, 0.28], 3.0), PointLight((0.5, 0.4, 1.5), 1.0)

    def size(v):
        return mp.sqrt(sum(s * x * x for s, x in zip((mp.mpf(1), mp.mpf(0.25), mp.mpf(0.04)), v, strict=True)))

    reference = single_scattering(medium, ray, light)
    within(
        reference,
        literal(
            lambda x: mp.mpf(0.5) * size(vector(ray.direction)),
            lambda x, y: mp.mpf(0.5) * size(minus(x, y)),
            0.6,
            lambda x: Isotropic(),
            ray,
            light,
        ),
    )


def test_a_function_and_the_grid_it_fills_agree():
    """Trilinear interpolation of a trilinear function is that function; the grid knows its planes, the function does not."""

    def sigma_t(x):
        return 0.5 + 0.05 * x[..., 0] * x[..., 1] - 0.02 * x[..., 2]

    centres = np.stack(np.meshgrid(*[np.linspace(-2.5, 2.5, 6)] * 3, indexing="ij"), axis=-1)
    grid = VoxelGrid(sigma_t(centres), (-3, -3, -3), (3, 3, 3), albedo=0.5)
    function = Procedural(sigma_t, 1.0, lower=(-2.5,) * 3, upper=(2.5,) * 3, albedo=0.5)
    inner = Ray([-2, 0.3, 0.1], [0.8, 0.6, 0], 3.0)
    for light in LIGHTS[:1] + LIGHTS[2:4]:
        one, two = (single_scattering(medium, inner, light) for medium in (grid, function))
        assert abs(one.value - two.value) <= one.error + two.error
        assert two.error <= 1e-8 * two.value + 1e-300


def test_a_phase_function_that_varies_in_space():
    ramp = Ramp((-2, 0, 0), (2, 0, 0))
    medium = LinearMedium(0.3, (0, 0, 0.0), 0.5, VaryingPhase(HenyeyGreenstein(0.8), Isotropic(), ramp))
    ray, light = Ray([-1.5, 0.3, 0.1], [0.8, 0.6, 0], 3.0), PointLight((0.1, 0.2, 1.0), 2.0)
    reference = single_scattering(medium, ray, light)

    def tau(x, y):
        v = minus(x, y)
        return mp.mpf(0.3) * mp.sqrt(dot(v, v))

    def share(x):
        return (x[0] + 2) / 4

    forward = literal(lambda x: mp.mpf(0.3) * (1 - share(x)), tau, 0.5, lambda x: HenyeyGreenstein(0.8), ray, light)
    within(reference, forward + literal(lambda x: mp.mpf(0.3) * share(x), tau, 0.5, lambda x: Isotropic(), ray, light))


def test_the_light_on_the_ray():
    grid = VoxelGrid(np.ones((2, 2, 2)), (-1, -1, -1), (1, 1, 1), albedo=0.5)
    ray = Ray([0, 0, -3], [0, 0, 1.0], 6.0)
    assert single_scattering(grid, ray, PointLight((0, 0, 0.5), 1.0)).value == math.inf
    with pytest.raises(UnsupportedError, match="meets the light"):
        single_scattering(grid, ray, PointLight((0, 0, 2.0), 1.0))
    behind = single_scattering(grid, ray, PointLight((0, 0, 5.0), 1.0))
    assert 0 < behind.value < math.inf


def test_an_empty_medium_scatters_nothing():
    reference = single_scattering(LinearMedium(0.0, (0, 0, 0.0), 0.5), RAY, LIGHTS[0])
    assert np.all(reference.value == 0)
    assert np.all(reference.error < 1e-300)


def test_an_endless_ray_through_a_medium_without_end_is_refused():
    with pytest.raises(UnsupportedError, match="length"):
        single_scattering(ExponentialMedium(1.0, (0, 0, -1.0), 0.5), Ray([0, 0, 0], [0, 0, 1.0]), LIGHTS[0])
