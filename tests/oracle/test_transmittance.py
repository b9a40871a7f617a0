"""Invariant: transmittance is exp(-integral of sigma_t) within its stated error, for every optical thickness."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from media_truth import DIGITS, exact, within

from fogproof.analytic import (
    optical_thickness,
    transmittance,
)
from fogproof.errors import InvalidValueError
from fogproof.scene import Medium, Ray

X, Z = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
sigmas = st.one_of(st.just(0.0), st.floats(-300, 8).map(lambda x: 10.0**x))
lengths = st.one_of(st.just(np.inf), st.floats(-300, 300).map(lambda x: 10.0**x))
thicknesses = st.floats(-300, 3).map(lambda x: 10.0**x)


def literal_tau(sigma_a, sigma_s, s):
    sigma_t = exact(sigma_a) + exact(sigma_s)
    return sigma_t * exact(s) if sigma_t else mp.mpf(0)


def check(sigma_a, sigma_s, s):
    medium, ray = Medium(sigma_a, sigma_s), Ray(X, Z, s)
    with np.errstate(all="raise"):
        thickness, survived = optical_thickness(medium, ray), transmittance(medium, ray)
    with mp.workdps(DIGITS):
        tau = literal_tau(sigma_a, sigma_s, s)
        truth = mp.exp(-tau) if tau != mp.inf else mp.mpf(0)
        if tau < mp.mpf(1e308):
            assert within(thickness, tau) <= 1e-15 or tau < 1e-290
        else:
            assert thickness.value > 1e307
        relative = within(survived, truth)
        if truth > 1e-300:
            assert relative <= 1e-14
            assert survived.error <= 1e-14 * survived.value


@given(sigmas, sigmas, lengths)
def test_anywhere(sigma_a, sigma_s, s):
    check(sigma_a, sigma_s, s)


@given(thicknesses, st.floats(-8, 8), st.floats(0, 1))
def test_at_every_thickness(tau, log_s, share):
    s = 10.0**log_s
    check(share * tau / s, (1 - share) * tau / s, s)


@given(sigmas, st.floats(1e-6, 1e6), st.floats(0.01, 0.99), st.floats(0, 1))
def test_multiplicative(sigma_t, s, share, absorbed):
    """T(x, x'') = T(x, x') T(x', x''); both lengths are multiples of the last digit of s, so that they add up exactly."""
    medium = Medium(absorbed * sigma_t, sigma_t - absorbed * sigma_t)
    first = float(np.rint(share * s / np.spacing(s)) * np.spacing(s))
    whole, one, two = (transmittance(medium, Ray(X, Z, length)) for length in (s, first, s - first))
    product = one.value * two.value
    allowed = whole.error + one.error * two.value + two.error * one.value + 2.0**-52 * product + 1e-320
    assert abs(product - whole.value) <= allowed


@pytest.mark.parametrize(
    ("sigma_a", "sigma_s", "s", "expected"),
    [
        (0.0, 0.0, np.inf, 1.0),
        (0.0, 0.0, 3.0, 1.0),
        (0.0, 1e-300, np.inf, 0.0),
        (1e8, 0.0, 1e300, 0.0),
        (0.25, 0.25, 1e-300, 1.0),
    ],
)
def test_limits(sigma_a, sigma_s, s, expected):
    with np.errstate(all="raise"):
        assert transmittance(Medium(sigma_a, sigma_s), Ray(X, Z, s)).value == expected


def test_shapes_and_channels():
    rays = Ray(np.zeros((2, 3, 3)), Z, np.ones((2, 3)))
    assert transmittance(Medium(0.1, 0.2), rays).value.shape == (2, 3)
    assert transmittance(Medium((0.1, 0.2), 0.2), rays).value.shape == (2, 3, 2)
    assert transmittance(Medium((0.1, 0.2), 0.2), Ray(X, Z, 1.0)).value.shape == (2,)
    assert transmittance(Medium(0.1, 0.2, emission=(1.0, 2.0)), rays).error.shape == (2, 3, 2)
    two = transmittance(Medium((0.1, 0.7), 0.2), rays).value
    assert np.array_equal(two[..., 1], transmittance(Medium(0.7, 0.2), rays).value)


@pytest.mark.parametrize("call", [optical_thickness, transmittance])
@pytest.mark.parametrize(
    ("medium", "ray", "argument"), [("fog", Ray(X, Z, 1.0), "medium"), (Medium(1.0, 0.0), 2.0, "ray")]
)
def test_wrong_types_are_named(call, medium, ray, argument):
    with pytest.raises(InvalidValueError) as raised:
        call(medium, ray)
    assert raised.value.argument == argument


def test_a_coefficient_that_overflows_is_refused():
    with pytest.raises(InvalidValueError, match="sigma_t"):
        Medium(1.5e308, 1.5e308)
