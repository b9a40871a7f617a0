"""Invariant: the variance of ambient fog is that of its two values, within the stated error of 60 digits."""

import mpmath as mp
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from media_truth import DIGITS, exact, within

from fogproof.analytic import ambient_fog, ambient_fog_variance, transmittance
from fogproof.scene import ExponentialMedium, Medium, Ray

Z = (0.0, 0.0, 1.0)
sigmas = st.one_of(st.just(0.0), st.floats(-9, 2.5).map(lambda e: 10.0**e))
lengths = st.floats(-6, 2).map(lambda e: 10.0**e)
positive = st.one_of(st.just(0.0), st.floats(1e-3, 1e3))


@settings(max_examples=200, deadline=None)
@given(sigma_a=sigmas, sigma_s=sigmas, s=lengths, ambient=positive, background=positive, emission=positive)
def test_fog(sigma_a, sigma_s, s, ambient, background, emission):
    medium, ray = Medium(sigma_a, sigma_s, emission=emission), Ray((0, 0, 0), Z, s)
    with mp.workdps(DIGITS + 400):
        a, k, s_, Li, Lbg, Le = map(exact, (sigma_a, sigma_s, s, ambient, background, emission))
        T = mp.exp(-(a + k) * s_)
        source = (k * Li + a * Le) / (a + k) if a + k else mp.mpf(0)
        truth = (source - Lbg) ** 2 * T * (1 - T)
        within(ambient_fog_variance(medium, ray, ambient, background), truth)


def test_fog_of_two_values_has_their_variance():
    medium, ray = ExponentialMedium(1.0, (0, 0, -0.5), albedo=0.7, emission=2.0), Ray((0, 0, 0), Z, 1.5)
    L = ambient_fog(medium, ray, 1.0, 4.0).value
    T = transmittance(medium, ray).value
    source = 0.7 * 1.0 + 0.3 * 2.0
    expected = T * (4.0 - L) ** 2 + (1 - T) * (source - L) ** 2
    assert ambient_fog_variance(medium, ray, 1.0, 4.0).value == pytest.approx(float(expected), rel=1e-13)
