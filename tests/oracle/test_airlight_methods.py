"""Invariant: every named way to the airlight integral keeps |value - truth| <= error, whatever it is asked, so that all
agree within their errors; what it cannot deliver to two digits it refuses, and says what to use instead.
"""

import numpy as np
import pytest
from airlight_truth import airlight
from hypothesis import given, settings
from hypothesis import strategies as st
from media_truth import within
from test_airlight import other_phases, phases, powers, segments

from fogproof.analytic import (
    airlight_integral,
    single_scattering,
)
from fogproof.analytic.airlight.integral import ALTERNATIVES
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import (
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    Medium,
    Murky,
    PointLight,
    Ray,
    Rayleigh,
    Schlick,
    Tabulated,
)

ISOTROPIC_ONLY = ("sun2005", "pegoraro2009")
polynomials = st.one_of(
    st.sampled_from([Isotropic(), Rayleigh(), Hazy(), Murky()]), st.floats(-0.6, 0.6).map(HenyeyGreenstein)
)
typical = st.tuples(powers(-2, 1), powers(-2, 1), st.floats(-10, 5), powers(-1, 1.3)).map(
    lambda x: (x[0], x[1], x[2], x[2] + x[3])
)
any_segment = st.one_of(typical, segments())


def integrate(method, segment, phase):
    """Return what the method itself says, before the refusal."""
    with np.errstate(all="ignore"):
        value, error = ALTERNATIVES[method].integrate(*(np.array([x]) for x in segment), phase)
    return Reference(value, error, method, "")


def agree(method, segment, phase):
    reference = integrate(method, segment, phase)
    if reference.error[0] < np.inf:
        within(reference, airlight(*segment, phase), 0)


@pytest.mark.parametrize("method", ISOTROPIC_ONLY)
@given(any_segment)
@settings(max_examples=100, deadline=None)
def test_isotropic_methods_are_honest(method, segment):
    agree(method, segment, Isotropic())


@given(any_segment, polynomials)
@settings(max_examples=100, deadline=None)
def test_the_series_is_honest(segment, phase):
    agree("pegoraro2010", segment, phase)


@given(any_segment, st.one_of(phases, other_phases))
@settings(max_examples=150, deadline=None)
def test_equiangular_quadrature_is_honest(segment, phase):
    agree("equiangular", segment, phase)


def test_all_agree_where_all_deliver():
    h, a, b = np.array([0.5, 2.0, 1.0]), np.array([-3.0, -1.0, -8.0]), np.array([2.0, 4.0, 0.5])
    exact = airlight_integral(0.4, h, a, b)
    digits = {"equiangular": 1e-9, "sun2005": 1e-3, "pegoraro2009": 1e-11, "pegoraro2010": 1e-11}
    for method, accuracy in digits.items():
        other = airlight_integral(0.4, h, a, b, method=method)
        assert np.all(np.abs(other.value - exact.value) <= other.error + exact.error)
        assert np.all(other.error <= accuracy * other.value), method
        assert method[:3] in other.method.lower()


@pytest.mark.parametrize("method", sorted(ALTERNATIVES))
def test_rays_in_space_by_every_method(method):
    medium, light = Medium(0.05, 0.3), PointLight((0.0, 1.0, 2.0), 5.0)
    ray = Ray([0, 0, 0], [[0, 0, 1.0], [0.6, 0, 0.8]], 6.0)
    exact, other = single_scattering(medium, ray, light), single_scattering(medium, ray, light, method=method)
    assert np.all(np.abs(exact.value - other.value) <= exact.error + other.error)
    assert np.all(other.error <= 1e-2 * other.value)
    assert other.method != exact.method


@pytest.mark.parametrize("method", sorted(ALTERNATIVES))
def test_the_light_on_the_segment_is_infinite_by_every_method(method):
    assert airlight_integral(1.0, 0.0, -1.0, 1.0, method=method).value == np.inf


@pytest.mark.parametrize(
    ("method", "segment", "phase"),
    [
        ("sun2005", (30.0, 1.0, -1.0, 1.0), Isotropic()),  # beyond the table
        ("sun2005", (1.0, 0.01, 1.0, 1.01), Isotropic()),  # the difference of two entries drowns
        ("pegoraro2009", (1.0, 1e-14, 5.0, 6.0), Isotropic()),  # light far behind
        ("pegoraro2010", (1.0, 1.0, -1.0, 1.0), HenyeyGreenstein(0.95)),  # too many terms
        ("equiangular", (100.0, 1e-8, -1e-3, 30.0), HenyeyGreenstein(-0.9999)),
        ("equiangular", (1.0, 1.0, -1.0, 1.0), Tabulated.normalised((-1, 0, 1), (1, 2, 1))),
        ("sun2005", (1.0, 1.0, -1.0, 1.0), Rayleigh()),
        ("pegoraro2009", (1.0, 1.0, -1.0, 1.0), HenyeyGreenstein(0.1)),
        ("pegoraro2010", (1.0, 1.0, -1.0, 1.0), Tabulated((-1, 1), (1 / (4 * np.pi),) * 2)),
        ("pegoraro2010", (1.0, 1.0, -1.0, 1.0), Schlick(0.5)),
    ],
)
def test_refusals(method, segment, phase):
    assert airlight_integral(*segment, phase).value > 0
    with pytest.raises(UnsupportedError):
        airlight_integral(*segment, phase, method)


def test_an_unknown_method_is_named():
    with pytest.raises(InvalidValueError, match=r"equiangular.*got 'simpson'"):
        airlight_integral(1.0, 1.0, 0.0, 1.0, method="simpson")
