"""Cosines, thicknesses, albedos and radii at the ends of what a number can hold."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from fogproof import analytic
from fogproof.errors import InvalidValueError
from fogproof.scene import HenyeyGreenstein, Medium, Rayleigh

SMALLEST = 5e-324


@pytest.mark.parametrize(
    ("function", "phase"),
    [
        (analytic.slab_reflectance, None),
        (analytic.slab_transmittance, None),
        (analytic.slab_emissivity, None),
        (analytic.slab_reflectance, Rayleigh()),
    ],
)
def test_the_most_grazing_beam_sees_what_grazing_beams_see(function, phase):
    with np.errstate(all="raise", under="ignore"):
        ends, near = function(0.5, 1.0, SMALLEST, phase), function(0.5, 1.0, 1e-15, phase)
    assert np.isfinite(ends.error)
    assert abs(ends.value - near.value) <= ends.error + near.error + 1e-13 * near.value


@pytest.mark.parametrize("function", [analytic.slab_brdf, analytic.slab_btdf])
def test_directions_along_the_surface(function):
    ends, near = function(0.5, 1.0, SMALLEST, 0.5), function(0.5, 1.0, 1e-12, 0.5)
    back = function(0.5, 1.0, 0.5, SMALLEST)
    assert abs(ends.value - near.value) <= ends.error + near.error + 1e-10 * near.value
    assert abs(ends.value - back.value) <= ends.error + back.error
    assert ends.error < 1e-11 * ends.value


def test_light_scattered_once_between_cosines_that_almost_agree():
    with mp.workdps(60):
        for tau, mu0, mu in [(1, 0.5, 0.5), (1, 0.5, 0.5 + 1e-9), (30, 1e-3, 1e-3 + 1e-12), (0.3, 1e-4, 1e-3)]:
            a, b = mp.mpf(mu0), mp.mpf(mu)
            gain = tau * mp.exp(-tau / a) / a**2 if a == b else (mp.exp(-tau / a) - mp.exp(-tau / b)) / (a - b)
            found = analytic.slab_btdf(1e-200, tau, mu0, mu)
            assert abs(found.value - mp.mpf(1e-200) / (4 * mp.pi) * gain) <= found.error + 1e-13 * float(found.value)


@pytest.mark.parametrize("tau", [1e-5, 1.0, 40.0, 700.0, 1e5, 1e300])
def test_diffuse_light_through_a_slab_that_only_absorbs(tau):
    found = analytic.slab_diffuse_transmittance(0.0, [tau, 1e5, 1.0])
    with mp.workdps(40):
        truth = 2 * mp.expint(3, mp.mpf(tau)) if tau < 1e6 else mp.mpf(0)
    assert abs(found.value[0] - truth) <= found.error[0]
    assert found.error[0] <= 1e-12 * truth + 1e-322


@pytest.mark.parametrize("albedo", [1e-300, 1e-12, 0.5, 1 - 2**-53])
@pytest.mark.parametrize("tau", [1e8 * 1.1, 1e20, 1e300])
def test_the_thickest_slabs_are_half_spaces(albedo, tau):
    found, whole = analytic.slab_diffuse_reflectance(albedo, tau), analytic.half_space_spherical_albedo(albedo)
    assert abs(found.value - whole.value) <= found.error + whole.error + 3e-8 * (albedo > 0.9)
    grazing, beam = analytic.slab_reflectance(albedo, tau, 1e-15), analytic.half_space_reflectance(albedo, 1e-15)
    assert abs(grazing.value - beam.value) <= grazing.error + beam.error + 3e-8 * (albedo > 0.9)


def test_what_passes_the_thickest_slab_that_does_not_absorb():
    found, thinner = analytic.slab_diffuse_transmittance(1.0, 1e300), analytic.slab_diffuse_transmittance(1.0, 1e10)
    assert found.value == pytest.approx(float(thinner.value) * 1e-290, rel=1e-9)
    assert 0 < found.error < 1e-11 * found.value


@pytest.mark.parametrize("mu0", [1e-300, 0.5])
def test_what_was_not_scattered_is_known_exactly(mu0):
    back = analytic.slab_reflectance_orders(1.0, mu0, 3)
    assert back.value[0] == back.error[0] == 0
    through = analytic.slab_transmittance_orders(1.0, mu0, 3)
    with mp.workdps(40):
        assert abs(through.value[0] - mp.exp(-1 / mp.mpf(mu0))) <= through.error[0] <= 4e-15
    if mu0 < 1e-9:  # the whole way down is lit
        assert abs(back.value[1] - (1 - mu0 * np.log1p(1 / mu0)) / 2) <= back.error[1]


@pytest.mark.parametrize("tau", [1e-300, 1e-20, 1e-14])
def test_orders_of_the_thinnest_slabs_are_at_most_the_chance_to_collide(tau):
    for phase in (None, HenyeyGreenstein(0.5)):
        found = analytic.slab_reflectance_orders(tau, 0.5, 3, phase)
        assert np.all(found.value >= 0)
        assert np.all(found.error <= tau / 0.5 * (1 + 1e-12) + 1e-323)
        if phase is None:
            assert abs(found.value[1] - tau) <= found.error[1] + 40 * tau**2


@pytest.mark.parametrize("radius", [1e-300, 1e-41, 1e-15])
def test_orders_of_the_smallest_balls_are_at_most_the_chance_to_collide(radius):
    found = analytic.ball_albedo_orders(radius, 4)
    assert abs(found.value[0] - (1 - 4 * radius / 3)) <= found.error[0]
    assert abs(found.value[1] - 4 * radius / 3) <= found.error[1] + radius**2
    assert np.all(found.error[1:] <= 4 * radius / 3)
    assert np.all(analytic.ball_radiance_orders(radius, 0.0, 4).error[1:] <= 2 * radius)


def test_orders_stay_between_nothing_and_everything():
    found = analytic.slab_reflectance_orders(1e-6, [1e-9, 0.1, 1.0], 8)
    assert np.all(found.value >= 0)
    assert np.all(found.value.sum(axis=-1) <= 1 + found.error.sum(axis=-1))


@pytest.mark.parametrize("size", [1e26, 1e100, 1.7e308])
def test_the_largest_numbers_are_deep(size):
    """Beyond 1e25 mean free paths nothing changes but what passes where nothing is absorbed."""
    for found in (
        analytic.slab_brdf(0.9, size, 0.5, 0.4),
        analytic.slab_reflectance_orders(size, 0.5, 2),
        analytic.ball_albedo([0.5, 1.0], size),
        analytic.ball_radiance(0.5, size, [0.0, 0.3 * size]),
        analytic.ball_albedo_orders(size, 2),
        analytic.rod_reflectance_orders(size, 2),
        analytic.rod_transmittance_orders(size, 2),
    ):
        assert np.isfinite(found.value).all()
        assert (found.error <= 1e-9).all()
    thin, deep = analytic.slab_btdf(1.0, 1e20, 0.5, 0.4), analytic.slab_btdf(1.0, 1e27, 0.5, 0.4)
    assert abs(deep.value * 1e7 - thin.value) <= deep.error * 1e7 + thin.error


@pytest.mark.parametrize("count", [10**40, 2**60, -1, 2.0, True])
def test_counts_that_no_memory_holds_are_refused(count):
    for ask in (
        lambda: analytic.slab_reflectance_orders(1.0, 0.5, count),
        lambda: analytic.rod_reflectance_orders(1.0, count),
        lambda: analytic.ball_albedo_orders(1.0, count),
        lambda: analytic.phase_legendre_moments(Rayleigh(), count),
    ):
        with pytest.raises(InvalidValueError, match="count"):
            ask()


@pytest.mark.parametrize("ray", [None, "x", 1.0, np.zeros(3)])
def test_what_is_no_ray_has_no_free_path(ray):
    with pytest.raises(InvalidValueError, match="ray"):
        analytic.free_path(Medium(0.1, 0.3), ray, 0.1)


@pytest.mark.parametrize(("c", "tau"), [(1.0, 3e3), (1.0, 1e8), (1 - 1e-12, 1e9), (0.9, 1e20), (0.99, 1.001e3)])
def test_a_deep_slab_is_the_half_space_but_for_what_passes(c, tau):
    """Against doubling, which knows of no half space."""
    mu0, mu = np.array([0.02, 0.5, 1.0]), np.array([0.7, 0.4, 0.05])
    found = analytic.slab_brdf(c, tau, mu0, mu)
    other = analytic.slab_brdf(c, tau, mu0, mu, HenyeyGreenstein(1e-18), 0.0)
    assert (np.abs(found.value - other.value) <= found.error + other.error).all()
    assert (found.error <= 2e-14 * found.value).all()
    passed = analytic.slab_btdf(c, tau, mu0, mu)
    whole = analytic.half_space_brdf(c, mu0, mu)
    assert (np.abs(found.value + passed.value - whole.value) <= found.error + passed.error + whole.error).all()
