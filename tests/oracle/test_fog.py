"""Invariant: ambient fog is the lerp of background, ambient and emitted radiance within its stated error, from
tau = 0 to infinity; in a furnace it is exactly the furnace's radiance."""

import json
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from media_truth import DIGITS, fog, within

from fogproof.analytic import ambient_fog
from fogproof.errors import InvalidValueError
from fogproof.scene import Medium, Ray

X, Z = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
VALUES = json.loads((Path(__file__).parents[1] / "data" / "reference-values.json").read_text())["fog_lerp"]
sigmas = st.one_of(st.just(0.0), st.floats(-300, 8).map(lambda x: 10.0**x))
lengths = st.one_of(st.just(np.inf), st.floats(-300, 300).map(lambda x: 10.0**x))
radiances = st.one_of(st.just(0.0), st.floats(1e-6, 1e6))


def check(sigma_a, sigma_s, emission, s, ambient, background):
    with np.errstate(all="raise"):
        reference = ambient_fog(Medium(sigma_a, sigma_s, emission=emission), Ray(X, Z, s), ambient, background)
    truth = fog(sigma_a, sigma_s, emission, s, ambient, background)
    relative = within(reference, truth)
    if truth > 1e-290:
        assert relative <= 1e-14
        assert reference.error <= 1e-14 * reference.value


@pytest.mark.parametrize("case", VALUES, ids=lambda case: f"s={case['s']}")
def test_reference_values(case):
    medium = Medium(case["sigma_a"], case["sigma_s"], emission=case["Le"])
    reference = ambient_fog(medium, Ray(X, Z, case["s"]), case["Li"], case["L_bg"])
    with mp.workdps(DIGITS):
        truth = mp.mpf(case["L"])
        assert abs(mp.mpf(float(reference.value)) - truth) <= 1e-14 * truth
        # The table has 32 digits; its own last digit is no part of the promise.
        assert abs(mp.mpf(float(reference.value)) - truth) <= float(reference.error) + mp.mpf(10) ** -31 * truth


@given(sigmas, sigmas, radiances, lengths, radiances, radiances)
def test_anywhere(sigma_a, sigma_s, emission, s, ambient, background):
    check(sigma_a, sigma_s, emission, s, ambient, background)


@given(st.floats(-300, 3), st.floats(-8, 8), st.floats(0, 1), radiances, radiances, radiances)
def test_at_every_thickness(log_tau, log_s, share, emission, ambient, background):
    s, sigma_t = 10.0**log_s, 10.0**log_tau / 10.0**log_s
    check(share * sigma_t, (1 - share) * sigma_t, emission, s, ambient, background)


@given(sigmas, sigmas, lengths, radiances)
def test_furnace(sigma_a, sigma_s, s, radiance):
    """Ambient, emission and background all equal: the fog is invisible, for every albedo."""
    reference = ambient_fog(Medium(sigma_a, sigma_s, emission=radiance), Ray(X, Z, s), radiance, radiance)
    within(reference, mp.mpf(radiance))


def test_extremes_do_not_overflow():
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        medium = Medium(1e8, 1e8, emission=1e300)
        reference = ambient_fog(medium, Ray(X, Z, 1e305), 1e300, 1e300)
    within(reference, mp.mpf(1e300))


def test_shapes_and_channels():
    rays = Ray(np.zeros((4, 3)), Z, np.array([0.5, 1.0, 7.0, np.inf]))
    assert ambient_fog(Medium(0.1, 0.2), rays, 1.0, 2.0).value.shape == (4,)
    assert ambient_fog(Medium(0.1, 0.2), Ray(X, Z, 1.0), 1.0, 2.0).value.shape == ()
    for fogs in (
        ambient_fog(Medium(0.1, 0.2), rays, (1.0, 2.0, 3.0), 2.0),
        ambient_fog(Medium(0.1, 0.2), rays, 1.0, (1.0, 2.0, 3.0)),
        ambient_fog(Medium(0.1, 0.2, emission=(1.0, 2.0, 3.0)), rays),
        ambient_fog(Medium((0.1, 0.2, 0.3), 0.2), rays, 1.0),
    ):
        assert fogs.value.shape == fogs.error.shape == (4, 3)


@pytest.mark.parametrize(
    ("ambient", "background", "argument"),
    [
        (-1.0, 0.0, "ambient"),
        (0.0, np.nan, "background"),
        ("bright", 0.0, "ambient"),
        ((1.0, 2.0), (1.0,) * 3, "ambient"),
    ],
)
def test_bad_radiances_are_named(ambient, background, argument):
    with pytest.raises(InvalidValueError) as raised:
        ambient_fog(Medium(0.1, 0.2), Ray(X, Z, 1.0), ambient, background)
    assert raised.value.argument == argument
