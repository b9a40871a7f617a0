"""Invariant: the H function solves Chandrasekhar's equation, and what a half space reflects is what follows from it, within
the stated error, from an albedo of 0 to 1 and at grazing angles."""

import json
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from media_truth import within

from fogproof.analytic import (
    chandrasekhar_h,
    half_space_brdf,
    half_space_reflectance,
    half_space_reflectance_orders,
    half_space_spherical_albedo,
)
from fogproof.errors import InvalidValueError

VALUES = json.loads((Path(__file__).parents[1] / "data" / "reference-values.json").read_text())
albedos = st.one_of(st.sampled_from([0.0, 1.0]), st.floats(0, 1), st.floats(-16, 0).map(lambda x: 1 - 10.0**x))
cosines = st.one_of(st.just(1.0), st.floats(-12, 0).map(lambda x: 10.0**x))


def h_rows():
    for c, row in VALUES["H_function"].items():
        for mu, value in row.items():
            if mu != "plane_albedo":
                yield float(c), float(mu), value, row["plane_albedo"].get(mu)


@pytest.mark.parametrize(("c", "mu", "value", "plane_albedo"), list(h_rows()))
def test_reference_values(c, mu, value, plane_albedo):
    assert within(chandrasekhar_h(c, mu), mp.mpf(value)) < 4e-15
    if plane_albedo:
        within(half_space_reflectance(c, mu), mp.mpf(plane_albedo))


def test_published_values():
    """H(1) for c = 1 and Hopf's constant, the extrapolation length of Milne's problem, known to 20 digits."""
    assert within(chandrasekhar_h(1.0, 1.0), mp.mpf("2.90781052907860571505696853174")) < 1e-15
    y, w = np.polynomial.legendre.leggauss(64)
    y, w = (1 + y) / 2, w / 2
    H = chandrasekhar_h(1.0, y * y).value
    first, second = (float(np.sum(2 * y * w * H * (y * y) ** n)) for n in (1, 2))
    assert second / first == pytest.approx(0.71044608959876307, rel=1e-14)


@given(albedos, st.floats(0.001, 1))
def test_the_nonlinear_equation(c, mu):
    """1/H(mu) = sqrt(1 - c) + c/2 int_0^1 mu' H(mu')/(mu + mu') dmu', by quadrature in sqrt(mu')."""
    y, w = np.polynomial.legendre.leggauss(96)
    y, w = (1 + y) / 2, w / 2
    nodes = y**4
    right = np.sqrt(1 - c) + c / 2 * np.sum(4 * y**3 * w * nodes * chandrasekhar_h(c, nodes).value / (mu + nodes))
    assert chandrasekhar_h(c, mu).value * right == pytest.approx(1, abs=1e-12)


@given(albedos, cosines, cosines)
def test_reflection_is_reciprocal_and_within_bounds(c, mu0, mu):
    with np.errstate(all="raise"):
        assert half_space_brdf(c, mu0, mu).value == pytest.approx(half_space_brdf(c, mu, mu0).value, rel=1e-14)
        reflected = half_space_reflectance(c, mu0)
        assert -reflected.error <= reflected.value <= c + reflected.error
        assert chandrasekhar_h(c, mu0).value >= 1 - 1e-15


@given(st.floats(0, 1), st.floats(0.01, 1))
@settings(max_examples=30)
def test_the_brdf_integrates_to_the_plane_albedo_and_that_to_the_spherical_albedo(c, mu0):
    y, w = np.polynomial.legendre.leggauss(96)
    y, w = (1 + y) / 2, w / 2
    mu, weight = y**4, 4 * y**3 * w
    plane = 2 * np.pi * np.sum(weight * mu * half_space_brdf(c, mu0, mu).value)
    assert plane == pytest.approx(half_space_reflectance(c, mu0).value, abs=1e-13)
    spherical = 2 * np.sum(weight * mu * half_space_reflectance(c, mu).value)
    assert spherical == pytest.approx(half_space_spherical_albedo(c).value, abs=1e-13)


@pytest.mark.parametrize("c", ["0.5", "0.9", "0.99"])
def test_spherical_albedo(c):
    reference = half_space_spherical_albedo(float(c))
    assert abs(reference.value - float(VALUES["halfspace_spherical_albedo"][c])) <= reference.error


def test_limits():
    assert half_space_spherical_albedo([0.0, 1.0]).value.tolist() == [0, 1]
    assert half_space_reflectance(1.0, [1e-300, 0.3, 1.0]).value == pytest.approx(1, abs=1e-14)
    assert np.all(half_space_reflectance(0.0, [1e-300, 1.0]).value == 0)
    # Diffusion theory near c = 1: 1 - A = 4 sqrt((1 - c)/3) to first order.
    assert 1 - half_space_spherical_albedo(1 - 1e-10).value == pytest.approx(4 * np.sqrt(1e-10 / 3), rel=1e-4)


def h_series(mu, w, count):
    """Coefficients of H at the nodes, from H = 1 + c/2 mu H int H(mu')/(mu + mu') dmu': positive terms only."""
    H = [np.ones_like(mu)]
    for n in range(1, count + 1):
        inner = [(w * H[k] / (mu[:, None] + mu)).sum(axis=1) for k in range(n)]
        H.append(mu / 2 * sum(H[n - 1 - k] * inner[k] for k in range(n)))
    return np.array(H)


def test_orders_follow_the_recursion_of_the_nonlinear_equation():
    y, w = np.polynomial.legendre.leggauss(48)
    y, w = (1 + y) / 2, w / 2
    mu, weight, count = y**3, 3 * y**2 * w, 12
    H = h_series(mu, weight, count)
    roots = np.array([float(mp.binomial(0.5, n)) * (-1) ** n for n in range(count + 1)])  # of sqrt(1 - c)
    orders = -np.array([sum(roots[n - k] * H[k] for k in range(n + 1)) for n in range(count + 1)])
    orders[0] += 1
    found = half_space_reflectance_orders(mu, count)
    resolved = mu > 0.05  # by the rule of 48 nodes
    assert np.all((np.abs(found.value - orders.T) <= found.error + 1e-12)[resolved])
    assert found.error.max() < 1e-10


def test_orders_begin_with_single_scattering_and_add_up():
    mu = np.array([[0.05], [0.4], [1.0]])
    found = half_space_reflectance_orders(mu, 30)
    assert found.value.shape == (3, 1, 31)
    assert np.all(np.abs(found.value[..., 0]) <= found.error[..., 0])
    single = (1 - mu * np.log1p(1 / mu)) / 2
    assert np.all(np.abs(found.value[..., 1] - single) <= found.error[..., 1])
    total = np.sum(found.value * 0.3 ** np.arange(31), axis=-1)
    assert total == pytest.approx(half_space_reflectance(0.3, mu).value, abs=1e-11)


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda: chandrasekhar_h(1.1, 0.5), "albedo"),
        (lambda: chandrasekhar_h(0.5, 0.0), "mu"),
        (lambda: half_space_reflectance(0.5, [0.5, np.nan]), "mu0"),
        (lambda: half_space_brdf(0.5, 0.5, 1.5), "mu"),
        (lambda: half_space_reflectance_orders(0.5, -1), "count"),
    ],
)
def test_bad_arguments_are_named(call, argument):
    with pytest.raises(InvalidValueError) as raised:
        call()
    assert raised.value.argument == argument
