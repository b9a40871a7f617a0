"""Invariant: the infinite medium, the rod, moments of flights and mean path lengths have the values of their integrals
and sums, within the stated error."""

import itertools
import json
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from media_truth import within

from fogproof.analytic import (
    mean_displacement,
    mean_path_length,
    mean_scatterings,
    mean_square_displacement,
    point_source_collisions,
    point_source_fluence,
    rod_reflectance,
    rod_reflectance_orders,
    rod_transmittance,
    rod_transmittance_orders,
)
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene.shapes import Ball, Box, HalfSpace, Slab

FLUENCE = json.loads((Path(__file__).parents[1] / "data" / "reference-values.json").read_text())[
    "infinite_medium_point_source_fluence"
]["values"]
albedos = st.one_of(st.sampled_from([0.0, 1.0]), st.floats(0, 1), st.floats(-16, 0).map(lambda x: 1 - 10.0**x))


@pytest.mark.parametrize(
    ("c", "r", "phi"), [(c, r, phi) for c, row in FLUENCE.items() for r, phi in row["phi"].items()]
)
def test_fluence_values(c, r, phi):
    assert within(point_source_fluence(float(c), float(r)), mp.mpf(phi)) < 1e-14


def collided_fluence(c, r):
    """Uncollided light plus the Fourier integral of everything else, 1/(2 pi^2 r) int c a^2/(1 - c a) k sin(k r) dk."""
    with mp.workdps(25):
        c, r = mp.mpf(c), mp.mpf(r)

        def a(k):
            return mp.atan(k) / k

        tail = mp.quadosc(lambda k: c * a(k) ** 2 / (1 - c * a(k)) * k * mp.sin(k * r), [0, mp.inf], omega=r)
        return mp.exp(-r) / (4 * mp.pi * r * r) + tail / (2 * mp.pi**2 * r)


@pytest.mark.parametrize(("c", "r"), [(0.3, 2.0), (0.97, 0.7), (1 - 2.0**-20, 3.0), (2.0**-10, 1.0)])
def test_fluence_by_fourier_transform(c, r):
    truth = collided_fluence(c, r)
    reference = point_source_fluence(c, r)
    assert abs(float(reference.value - truth)) <= reference.error + 1e-11 * float(truth)


@given(albedos, st.floats(-6, 2.5).map(lambda x: 10.0**x))
@settings(max_examples=40, deadline=None)
def test_collisions_are_the_integral_of_the_fluence(c, radius):
    with np.errstate(all="raise"):
        y, w = np.polynomial.legendre.leggauss(80)
        edges = np.concatenate([[0.0], np.geomspace(min(radius, 1) / 8, radius, 12)])
        total = 0.0
        for low, high in itertools.pairwise(edges):
            r = low + (high - low) * (1 + y) / 2
            total += np.sum(w * (high - low) / 2 * 4 * np.pi * r * r * point_source_fluence(c, r).value)
        assert total == pytest.approx(point_source_collisions(c, radius).value, rel=1e-10)


def test_limits_of_the_infinite_medium():
    r = np.array([1e-9, 1.0, 50.0])
    bare = point_source_fluence(0.0, r)
    assert np.all(np.abs(bare.value - np.exp(-r) / (4 * np.pi * r * r)) <= bare.error)
    assert point_source_fluence(0.5, 0.0).value == np.inf
    far = np.array([1e3, 1e6])
    assert point_source_fluence(1.0, far).value * 4 * np.pi * far == pytest.approx(3, rel=1e-12)  # diffusion
    assert point_source_collisions([0.0, 0.5, 0.99], 1e4).value == pytest.approx([1, 2, 100], rel=1e-12)
    short = point_source_collisions(0.0, [0.0, 1e-9, 0.7])
    assert np.all(np.abs(short.value + np.expm1(-np.array([0.0, 1e-9, 0.7]))) <= short.error)


@given(albedos, st.floats(-8, 3).map(lambda x: 10.0**x), st.floats(-1, 1))
def test_rod_is_the_solution_of_two_equations(c, length, g):
    """dI+/dx = -a I+ + b I-, dI-/dx = a I- - b I+ with a = 1 - c (1 + g)/2 and b = c (1 - g)/2, as a matrix exponential."""
    with mp.workdps(900), np.errstate(all="raise"):
        a, b = 1 - mp.mpf(c) * (1 + mp.mpf(g)) / 2, mp.mpf(c) * (1 - mp.mpf(g)) / 2
        k2, L = a * a - b * b, mp.mpf(length)
        k = mp.sqrt(k2)
        cosh, sinh_over_k = mp.cosh(k * L), (mp.sinh(k * L) / k if k2 else L)
        # exp(M L) = cosh 1 + sinh/k M with M = [[-a, b], [-b, a]], and nothing enters at the far end.
        below, across = cosh + a * sinh_over_k, b * sinh_over_k
        within(rod_reflectance(c, length, g), across / below)
        within(rod_transmittance(c, length, g), 1 / below)


@given(st.floats(0, 20), st.floats(-0.95, 0.95))
@settings(max_examples=30)
def test_rod_orders_add_up(length, g):
    powers = 0.2 ** np.arange(31)
    for orders, whole in ((rod_reflectance_orders, rod_reflectance), (rod_transmittance_orders, rod_transmittance)):
        found = orders(length, 30, g)
        assert abs(found.value @ powers - whole(0.2, length, g).value) <= found.error @ powers + 1e-14
    assert abs(rod_transmittance_orders(length, 2, g).value[0] - np.exp(-length)) <= 1e-10
    single = (1 - g) / 4 * -np.expm1(-2 * length)
    assert abs(rod_reflectance_orders(length, 2, g).value[1] - single) <= 1e-10


def test_rod_without_absorption():
    length = np.array([0.0, 1e-9, 3.0, 1e300])
    assert rod_transmittance(1.0, length).value == pytest.approx(2 / (2 + length), rel=1e-14)
    assert rod_reflectance(1.0, length, 1.0).value.tolist() == [0, 0, 0, 0]


def flights_by_sum(n, g):
    """Sums over pairs of flights, exactly: E[l_i l_j cos] = g^|i - j| off the diagonal and E[l^2] = 2 on it."""
    g = mp.mpf(g)
    z = sum((g**i for i in range(n)), mp.mpf(0))
    square = sum((2 if i == j else g ** abs(i - j) for i in range(n) for j in range(n)), mp.mpf(0))
    return z, square


@given(st.integers(0, 40), st.floats(-1, 1))
@settings(max_examples=40)
def test_moments_of_flights(n, g):
    with mp.workdps(60):
        z, square = flights_by_sum(n, g)
        within(mean_displacement(n, g, 0.5), z / 2)
        within(mean_square_displacement(n, g, 0.5), square / 4)


def test_mean_path_lengths():
    box = Box((0, 0, 0), (1, 2, 4))
    for shape, value in (
        (Slab((0, 0, 0), (0, 0, 1), 3.0), 6.0),
        (Ball((1, 2, 3), 3.0), 4.0),
        (box, 4 * 8 / (2 * (2 + 8 + 4))),
    ):
        reference = mean_path_length(shape)
        assert abs(reference.value - value) <= reference.error
        assert mean_scatterings(shape, 2.5).value == pytest.approx(2.5 * value, rel=1e-15)
    with pytest.raises(UnsupportedError, match="HalfSpace"):
        mean_path_length(HalfSpace((0, 0, 0), (0, 0, 1)))


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda: point_source_fluence(0.5, -1.0), "distance"),
        (lambda: point_source_collisions(0.5, np.inf), "radius"),
        (lambda: rod_reflectance(0.5, 1.0, 1.5), "g"),
        (lambda: rod_transmittance_orders(np.nan, 3), "length"),
        (lambda: mean_displacement(1.5, 0.0), "flights"),
        (lambda: mean_square_displacement(3, 0.0, 0.0), "mean_free_path"),
        (lambda: mean_displacement(3, 1.1), "g"),
    ],
)
def test_bad_arguments_are_named(call, argument):
    with pytest.raises(InvalidValueError) as raised:
        call()
    assert raised.value.argument == argument
