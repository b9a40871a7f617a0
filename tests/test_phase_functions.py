"""Invariant: every phase function is a probability density over the sphere with the convention it states, and
|value - truth| <= error holds for density and distribution at every parameter and cosine, a few eps at worst.

The truth is the textbook formula, cancellations and all, in 80-digit arithmetic on the same binary64 inputs.
"""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fogproof.analytic import phase_cdf, phase_pdf
from fogproof.errors import InvalidValueError
from fogproof.scene import HenyeyGreenstein, Isotropic, Rayleigh

EPS = 2.0**-52
DIGITS = 80

one_minus = st.floats(2.0**-50, 1).map(lambda d: 1 - d)
cosines = st.one_of(st.floats(-1, 1), one_minus, one_minus.map(lambda c: -c), st.sampled_from([-1.0, 0.0, 1.0]))
asymmetries = st.one_of(
    st.floats(-1, 1, exclude_min=True, exclude_max=True),
    st.floats(-16, 0).map(lambda e: 10.0**e).filter(lambda g: g < 1),
    st.floats(-16, -1).map(lambda e: -(1 - 10.0**e)),
    st.sampled_from([0.0, -0.0, 1e-12, -1e-12, 0.9999, -0.9999, 5e-324, 1 - 2.0**-53, 2.0**-53 - 1]),
)
phases = st.one_of(st.just(Isotropic()), st.just(Rayleigh()), asymmetries.map(HenyeyGreenstein))


def true_pdf(phase, mu):
    match phase:
        case Isotropic():
            return 1 / (4 * mp.pi)
        case Rayleigh():
            return 3 / (16 * mp.pi) * (1 + mu**2)
        case HenyeyGreenstein(g):
            g = mp.mpf(g)
            return (1 - g**2) / (4 * mp.pi * (1 + g**2 - 2 * g * mu) ** 1.5)


def true_cdf(phase, mu):
    match phase:
        case Isotropic():
            return (1 + mu) / 2
        case Rayleigh():
            return (4 + 3 * mu + mu**3) / 8
        case HenyeyGreenstein(g) if abs(g) < 1e-30:
            return (1 + mu) / 2
        case HenyeyGreenstein(g):
            g = mp.mpf(g)
            return (1 - g**2) / (2 * g) * (1 / mp.sqrt(1 + g**2 - 2 * g * mu) - 1 / (1 + g))


def assert_contains(reference, truth, rtol):
    """The stated error covers the truth, and is not padded beyond rtol."""
    value, error = mp.mpf(float(reference.value)), mp.mpf(float(reference.error))
    assert abs(value - truth) <= error, (mp.nstr(value, 20), mp.nstr(truth, 20), float(error))
    assert error <= rtol * abs(truth) * (1 + 1e-10)


@settings(max_examples=400, deadline=None)
@given(phase=phases, mu=cosines)
def test_value_and_distribution_are_within_their_error(phase, mu):
    with mp.workdps(DIGITS):
        assert_contains(phase_pdf(phase, mu), true_pdf(phase, mp.mpf(mu)), 8 * EPS)
        assert_contains(phase_cdf(phase, mu), true_cdf(phase, mp.mpf(mu)), 6 * EPS)


@pytest.mark.parametrize("phase", [Isotropic(), Rayleigh(), *map(HenyeyGreenstein, (-0.9, -0.3, 1e-12, 0.5, 0.9))])
def test_normalisation_and_mean_cosine_by_quadrature(phase):
    nodes, weights = np.polynomial.legendre.leggauss(250)
    density = 2 * np.pi * phase_pdf(phase, nodes).value
    g = phase.g if isinstance(phase, HenyeyGreenstein) else 0
    assert density @ weights == pytest.approx(1, abs=1e-12)
    assert density @ (weights * nodes) == pytest.approx(g, abs=1e-12)
    assert phase_cdf(phase, [-1.0, 1.0]).value == pytest.approx([0, 1], abs=2e-16)


def test_forward_means_positive_g():
    assert phase_pdf(HenyeyGreenstein(0.7), 1.0).value > phase_pdf(HenyeyGreenstein(0.7), -1.0).value


def test_arrays_of_any_shape():
    mu = np.linspace(-1, 1, 2 * 70_000).reshape(2, 1, 70_000)
    whole = phase_pdf(HenyeyGreenstein(0.3), mu)
    assert whole.value.shape == whole.error.shape == mu.shape
    assert whole.value[1, 0, 12] == phase_pdf(HenyeyGreenstein(0.3), mu[1, 0, 12]).value
    assert phase_cdf(Rayleigh(), []).value.shape == (0,)
    assert phase_cdf(Rayleigh(), 0.5).value.shape == ()


@pytest.mark.parametrize("function", [phase_pdf, phase_cdf])
def test_a_cosine_is_refused_beyond_rounding(function):
    for phase in (Isotropic(), HenyeyGreenstein(0.9), Rayleigh()):
        for sign in (1, -1):
            assert function(phase, sign * (1 + 2 * EPS)).value == function(phase, sign * 1.0).value
            for bad in (sign * (1 + 1e-12), sign * np.inf, np.nan, [0.5, sign * 1.5]):
                with pytest.raises(InvalidValueError, match=r"mu must be a cosine in \[-1, 1\]"):
                    function(phase, bad)
    with pytest.raises(InvalidValueError, match="phase must be a phase function"):
        function("rayleigh", 0.5)
    with pytest.raises(InvalidValueError, match="mu must be a number"):
        function(Rayleigh(), "x")
