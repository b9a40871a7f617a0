"""Derivatives of the oracle's quantities against 50 digits, scattering orders and each other."""

import doctest
import importlib

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fogproof import analytic
from fogproof.analytic import gradient
from fogproof.analytic.derivatives.from_values import Disc, derivative_from_values
from fogproof.contracts import Reference
from fogproof.errors import FogproofError, InvalidValueError
from fogproof.scene import (
    DirectionalLight,
    HenyeyGreenstein,
    Isotropic,
    Medium,
    PiecewiseConstantMedium,
    PointLight,
    Ray,
    Scene,
    VoxelGrid,
)

mp.mp.dps = 50
RAY = Ray((0, 0, 0), (0, 0, 1), 2.0)
LAMP = PointLight((1.0, 1.0, 0.5), 3.0)


def holds(slope, truth, tightest=None):
    """Assert that the truth is within the bound, and the bound within reach of the truth."""
    off = np.abs(slope.value - np.asarray(truth, dtype=float))
    assert np.all(off <= slope.error), (slope.value, truth, slope.error)
    if tightest is not None:
        assert np.all(slope.error <= tightest * np.abs(truth)), slope.error / np.abs(truth)


@pytest.mark.parametrize("order", [1, 2])
@settings(max_examples=40)
@given(x=st.floats(-3, 3), rate=st.floats(0.1, 3), radius=st.floats(0.1, 2))
def test_cauchys_bound_holds_for_what_it_is_made_of(order, x, rate, radius):
    """exp(-rate x) reaches its bound in the disc at one point only."""
    disc = Disc(radius, np.asarray(np.exp(-rate * (x - radius))))
    value, error = derivative_from_values(
        lambda s: Reference(np.exp(-rate * s), 2e-16 * np.exp(-rate * s)), x, disc, order
    )
    truth = (-rate) ** order * np.exp(-rate * x)
    assert abs(value - truth) <= error + 8e-16 * abs(truth)


@settings(max_examples=40)
@given(radius=st.floats(0.01, 100), near=st.floats(1e-6, 1e-2))
def test_a_pole_just_outside_the_disc_is_counted(radius, near):
    pole = radius * (1 + near)
    disc = Disc(radius, np.asarray(1 / (pole - radius)))
    value, error = derivative_from_values(lambda s: Reference(1 / (pole - s), 4e-16 / (pole - s)), 0.0, disc)
    assert abs(value - pole**-2) <= error
    assert error <= 1e-9 / (radius**2 * near)  # 25 nodes within a quarter of the disc


def test_nodes_keep_to_one_side_where_nothing_may_be_asked_on_the_other():
    def f(s):
        assert 0 <= s <= 1
        return Reference(np.exp(s), 1e-15)

    for x, disc in ((1.0, Disc(4.0, np.exp(5.0), 1.0, 0.0)), (0.0, Disc(4.0, np.exp(4.0), 0.0, 1.0))):
        value, error = derivative_from_values(f, x, disc)
        assert abs(value - np.exp(x)) <= error <= 1e-10


@pytest.mark.parametrize("of", ["sigma_t", "sigma_a", "sigma_s"])
def test_transmittance_and_thickness(of):
    medium = Medium(0.3, 0.7)
    holds(gradient("transmittance", f"medium.{of}", medium=medium, ray=RAY), -2 * np.exp(-2.0), 1e-13)
    holds(gradient(analytic.optical_thickness, f"medium.{of}", medium=medium, ray=RAY), 2.0, 1e-13)


def test_emission_by_absorption():
    def emitted(a):
        return mp.mpf("0.4") * a / (a + mp.mpf(0.75)) * (1 - mp.exp(-2 * (a + mp.mpf(0.75))))

    slope = gradient("emitted_radiance", "medium.sigma_a", medium=Medium(0.25, 0.75, emission=0.4), ray=RAY)
    holds(slope, mp.diff(emitted, 0.25), 1e-11)
    assert "Cauchy" in slope.method


def _airlight(sigma_a, sigma_s, g):
    """Single scattering of LAMP along RAY in 50 digits, by the half angle of nothing: plain quadrature."""
    height, shift = mp.sqrt(2), mp.mpf(0.5)

    def seen(t):
        x = t - shift
        r = mp.sqrt(x * x + height**2)
        mu = -x / r  # towards the camera, against the ray
        lobe = (1 - g * g) / (4 * mp.pi * (1 + g * g - 2 * g * mu) ** mp.mpf("1.5"))
        return 3 * sigma_s * lobe * mp.exp(-(sigma_a + sigma_s) * (t + r)) / r**2

    return mp.quad(seen, [0, 0.5, 1, 2])


@pytest.mark.parametrize(
    ("wrt", "place"), [("medium.sigma_a", 0), ("medium.sigma_s", 1), ("medium.phase.g", 2), ("medium.sigma_t", None)]
)
def test_single_scattering(wrt, place):
    at = [mp.mpf(0.125), mp.mpf(0.5), mp.mpf(0.625)]
    medium = Medium(0.125, 0.5, HenyeyGreenstein(0.625))
    slope = gradient("single_scattering", wrt, medium=medium, ray=RAY, light=LAMP)
    if place is None:
        truth = mp.diff(lambda t: _airlight(t / 5, 4 * t / 5, at[2]), 0.625)
    else:
        truth = mp.diff(lambda x: _airlight(*at[:place], x, *at[place + 1 :]), at[place])
    holds(slope, truth, 1e-8)  # by sigma_s two terms almost cancel
    assert "Cauchy" in slope.method


def test_factors_of_the_light_are_straight_lines():
    scene = Scene(Medium(0.2, 0.6, HenyeyGreenstein(0.4)), RAY, "single", LAMP, background=0.5)
    whole = analytic.radiance(scene).value
    dark = analytic.radiance(Scene(scene.medium, RAY, "single", PointLight(LAMP.position, 0.0), background=0.5)).value
    holds(gradient("radiance", "light.intensity", scene=scene), (whole - dark) / 3, 1e-12)
    holds(gradient("radiance", "background", scene=scene), np.exp(-1.6), 1e-12)


def test_each_voxel_has_its_slope():
    sigma_t = np.random.default_rng(1).uniform(0.1, 2, (2, 1, 3))
    grid = VoxelGrid(sigma_t, (0, 0, 0), (2, 1, 3), "nearest")
    ray = Ray((-0.5, 0.5, -0.25), np.array([2.0, 0.0, 3.0]) / np.sqrt(13), 10.0)
    slopes = gradient("transmittance", "medium.sigma_t", medium=grid, ray=ray)
    assert slopes.value.shape == (2, 1, 3)
    through = analytic.transmittance(grid, ray).value
    lengths = -slopes.value / through
    ones = VoxelGrid(np.ones((2, 1, 3)), (0, 0, 0), (2, 1, 3), "nearest")
    assert np.sum(lengths) == pytest.approx(float(analytic.optical_thickness(ones, ray)))
    one = gradient("transmittance", "medium.sigma_t[1,0,2]", medium=grid, ray=ray)
    assert float(one) == slopes.value[1, 0, 2]
    layers = PiecewiseConstantMedium((0, 1, 3), (0.5, 0.25))
    holds(
        gradient("transmittance", "medium.sigma_t", medium=layers, ray=Ray((0, 0, 0), (0, 0, 1), 2.0)),
        -np.exp(-0.75),
        1e-13,
    )


def test_light_in_a_grid_by_one_voxel():
    """By quadrature on both sides, against a difference so fine that its own error is known."""
    ray = Ray((0, 0, -1), (0, 0, 1), 4.0)

    def arguments(x):
        grid = VoxelGrid(np.array([[[0.5, x, 1.0]]]), (-9, -9, 0), (9, 9, 3), "nearest", albedo=0.7)
        return {"medium": grid, "ray": ray, "light": DirectionalLight((0, 1, 0), 2.0)}

    slope = gradient("single_scattering", "medium.sigma_t[0,0,1]", **arguments(0.75))
    ends = [analytic.single_scattering(**arguments(0.75 + h)).value for h in (-1e-4, 1e-4)]
    rough = (ends[1] - ends[0]) / 2e-4
    assert abs(slope.value - rough) <= slope.error + 1e-7 * abs(rough)
    assert slope.error <= 1e-8


def _rod(c, length):
    """Reflected share of a rod, from the exponential of its 2 x 2 equation."""
    flow = mp.expm(length * mp.matrix([[-1 + c / 2, c / 2], [-c / 2, 1 - c / 2]]))
    return -flow[1, 0] / flow[1, 1]


@pytest.mark.parametrize("albedo", [0.0, 0.25, 0.875])
def test_rod(albedo):
    by_albedo = gradient("rod_reflectance", "albedo", albedo=albedo, length=2.0)
    holds(by_albedo, mp.diff(lambda c: _rod(c, 2), mp.mpf(albedo), direction=1 if albedo == 0 else 0), 1e-9)
    if albedo:
        by_length = gradient("rod_reflectance", "length", albedo=albedo, length=2.0)
        holds(by_length, mp.diff(lambda b: _rod(mp.mpf(albedo), b), 2), 1e-9)


@pytest.mark.parametrize("quantity", ["slab_reflectance", "slab_transmittance"])
@pytest.mark.parametrize("albedo", [0.3, 0.999999, 1.0])
def test_slab_by_albedo_is_the_series_of_its_orders(quantity, albedo):
    slope = gradient(quantity, "albedo", albedo=albedo, tau=0.5, mu0=[0.2, 0.9])
    orders = getattr(analytic, f"{quantity}_orders")(0.5, np.array([0.2, 0.9]), 60)
    n = np.arange(1, 61)
    series = orders.value[:, 1:] @ (n * albedo ** (n - 1.0))
    slack = orders.error[:, 1:] @ (n * albedo ** (n - 1.0))
    assert np.all(np.abs(slope.value - series) <= slope.error + slack)
    assert np.all(slope.error <= 1e-9)
    assert "Cauchy" in slope.method


def test_half_space_near_white():
    """R = 1 - sqrt(1 - c) H: its slope is infinite at c = 1, and still known relatively at 1 - 1e-6."""
    brdf_way = gradient("half_space_reflectance", "albedo", albedo=[0.5, 0.999999], mu0=0.5)
    assert np.all(brdf_way.error <= [1e-11, 1e-3])
    h = np.array([1e-4, 1e-10])
    c = np.array([0.5, 0.999999])
    rough = (analytic.half_space_reflectance(c + h, 0.5).value - analytic.half_space_reflectance(c - h, 0.5).value) / (
        2 * h
    )
    np.testing.assert_allclose(brdf_way.value, rough, rtol=1e-4)


def test_what_no_argument_bounds_is_estimated_and_said_to_be():
    slope = gradient("slab_reflectance", "mu0", albedo=0.9, tau=1.0, mu0=0.5)
    h = 1e-5
    rough = (
        analytic.slab_reflectance(0.9, 1.0, 0.5 + h).value - analytic.slab_reflectance(0.9, 1.0, 0.5 - h).value
    ) / (2 * h)
    assert abs(slope.value - rough) <= 1e-6 * abs(rough)
    assert "estimated" in slope.method
    by_g = gradient("slab_reflectance", "phase.g", albedo=0.9, tau=1.0, mu0=0.5, phase=HenyeyGreenstein(0.5))
    assert "estimated" in by_g.method
    assert by_g.value < 0


def test_arrays_broadcast():
    slope = gradient("half_space_reflectance", "albedo", albedo=[[0.2], [0.6]], mu0=[0.5, 1.0, 0.1])
    assert slope.value.shape == (2, 3)
    alone = gradient("half_space_reflectance", "albedo", albedo=0.6, mu0=0.1)
    assert float(alone) == pytest.approx(slope.value[1, 2])


@pytest.mark.parametrize(
    ("quantity", "wrt", "told"),
    [
        ("transmitance", "medium.sigma_t", "must be a quantity"),
        ("transmittance", "medium.sigma", "'sigma' is none of sigma_a, sigma_s, phase, emission, sigma_t, albedo"),
        ("transmittance", "medium.sigma_t[3]", "must lie within the shape"),
        ("transmittance", "medium.phase", "must name a number"),
        ("transmittance", "", "must be the name of a parameter"),
        ("transmittance", "medium[1].sigma_t", "must be names joined by dots"),
        ("transmittance", 3, "must be the name of a parameter"),
    ],
)
def test_wrong_names_are_told(quantity, wrt, told):
    with pytest.raises(InvalidValueError, match=told.replace("[", r"\[")):
        gradient(quantity, wrt, medium=Medium(0.5, 0.5, Isotropic()), ray=RAY)


def test_what_the_quantity_refuses_stays_refused():
    with pytest.raises(FogproofError, match="albedo must lie in"):
        gradient("half_space_reflectance", "albedo", albedo=1.5, mu0=0.5)


@pytest.mark.parametrize("module", ["gradient", "path_length", "scattering_counts"])
def test_examples_of_the_docstrings(module):
    results = doctest.testmod(importlib.import_module(f"fogproof.analytic.derivatives.{module}"), extraglobs={"np": np})
    assert results.attempted > 0
    assert results.failed == 0
