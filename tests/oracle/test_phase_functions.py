"""Invariant: every phase function is a probability density over the sphere with the convention it states, and
|value - truth| <= error holds for density, distribution, quantile and mean at every parameter, a few eps at worst.

The truth is the textbook formula, cancellations and all, in 120-digit arithmetic on the same binary64 inputs; only
Lorenz-Mie, which has no textbook formula, is tested elsewhere.
"""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from phase_truth import true_cdf, true_mean, true_pdf

from fogproof.analytic import phase_cdf, phase_mean_cosine, phase_pdf, phase_quantile
from fogproof.errors import InvalidValueError
from fogproof.scene import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    Mixture,
    Murky,
    Rayleigh,
    Schlick,
    Tabulated,
)

EPS = 2.0**-52
DIGITS = 120

one_minus = st.floats(2.0**-50, 1).map(lambda d: 1 - d)
cosines = st.one_of(st.floats(-1, 1), one_minus, one_minus.map(lambda c: -c), st.sampled_from([-1.0, 0.0, 1.0]))
asymmetries = st.one_of(
    st.floats(-1, 1, exclude_min=True, exclude_max=True),
    st.floats(-16, 0).map(lambda e: 10.0**e).filter(lambda g: g < 1),
    st.floats(-16, -1).map(lambda e: -(1 - 10.0**e)).filter(lambda g: g > -1),
    st.sampled_from([0.0, -0.0, 1e-12, -1e-12, 0.9999, -0.9999, 5e-324, 1 - 2.0**-53, 2.0**-53 - 1]),
)
alphas = st.one_of(st.floats(0, 2), st.floats(-20, 300).map(lambda e: 10.0**e))
probabilities = st.one_of(st.floats(0, 1), one_minus, st.sampled_from([0.0, 0.5, 1 - 2.0**-53, 1.0]))


@st.composite
def tables(draw):
    inner = draw(st.lists(st.floats(-0.999, 0.999), unique=True, max_size=6))
    cosines = [-1.0, *sorted(inner), 1.0]
    values = draw(st.lists(st.floats(0.01, 100), min_size=len(cosines), max_size=len(cosines)))
    return Tabulated.normalised(cosines, values)


@st.composite
def mixtures(draw, of):
    components = draw(st.lists(of, min_size=1, max_size=3))
    weights = np.array(draw(st.lists(st.floats(0.01, 1), min_size=len(components), max_size=len(components))))
    return Mixture(components, weights / weights.sum())


simple = st.one_of(
    st.sampled_from([Isotropic(), Rayleigh(), Hazy(), Murky()]),
    asymmetries.map(HenyeyGreenstein),
    asymmetries.map(Schlick),
    asymmetries.map(CornetteShanks),
    st.builds(Draine, asymmetries, alphas),
    st.builds(DoubleHenyeyGreenstein, asymmetries, asymmetries, st.floats(0, 1)),
    tables(),
)
phases = st.one_of(simple, mixtures(simple), mixtures(mixtures(simple)))


def assert_contains(reference, truth, rtol):
    """The stated error covers the truth, and is not padded beyond rtol."""
    value, error = mp.mpf(float(reference.value)), mp.mpf(float(reference.error))
    assert abs(value - truth) <= error + mp.mpf(2) ** -1060, (mp.nstr(value, 20), mp.nstr(truth, 20), float(error))
    assert error <= rtol * abs(truth) * (1 + 1e-10) + mp.mpf(2) ** -1060


@settings(max_examples=600, deadline=None)
@given(phase=phases, mu=cosines)
def test_value_and_distribution_are_within_their_error(phase, mu):
    with mp.workdps(DIGITS):
        assert_contains(phase_pdf(phase, mu), true_pdf(phase, mp.mpf(mu)), 50 * EPS)
        assert_contains(phase_cdf(phase, mu), true_cdf(phase, mp.mpf(mu)), 400 * EPS)


@settings(max_examples=400, deadline=None)
@given(g=asymmetries, mu=cosines)
def test_henyey_greenstein_has_a_few_eps(g, mu):
    with mp.workdps(DIGITS):
        assert_contains(phase_pdf(HenyeyGreenstein(g), mu), true_pdf(HenyeyGreenstein(g), mp.mpf(mu)), 8 * EPS)
        assert_contains(phase_cdf(HenyeyGreenstein(g), mu), true_cdf(HenyeyGreenstein(g), mp.mpf(mu)), 6 * EPS)


@settings(max_examples=300, deadline=None)
@given(phase=phases)
def test_mean_cosine_is_within_its_error(phase):
    with mp.workdps(DIGITS):
        mean = phase_mean_cosine(phase)
        assert abs(mp.mpf(float(mean.value)) - true_mean(phase)) <= float(mean.error) + mp.mpf(2) ** -1060
        assert mean.error <= 50 * EPS


@settings(max_examples=300, deadline=None)
@given(phase=phases, xi=probabilities)
def test_quantile_is_within_its_error(phase, xi):
    quantile = phase_quantile(phase, xi)
    with mp.workdps(DIGITS):
        mu, error = mp.mpf(float(quantile.value)), mp.mpf(float(quantile.error))
        assert -1 <= mu <= 1
        digits = mp.mpf(10) ** (10 - DIGITS)
        assert mu - error <= -1 or true_cdf(phase, mu - error) <= xi + digits
        assert mu + error >= 1 or true_cdf(phase, mu + error) >= xi - digits
        # and the interval, found by doubling, is no wider than rounding of the distribution explains
        low, high = max(mu - error / 4, mp.mpf(-1)), min(mu + error / 4, mp.mpf(1))
        mass = true_cdf(phase, high) - true_cdf(phase, low)
        assert error <= 16 * EPS or mass <= 2000 * EPS


kinds = [
    Isotropic(),
    Rayleigh(),
    Hazy(),
    Murky(),
    *map(HenyeyGreenstein, (-0.9, -0.3, 1e-12, 0.5, 0.9)),
    *map(Schlick, (-0.9, 1e-12, 0.7)),
    *map(CornetteShanks, (-0.7, 1e-12, 0.8)),
    Draine(0.6, 3.0),
    DoubleHenyeyGreenstein(0.8, -0.3, 0.7),
    Mixture((Murky(), HenyeyGreenstein(-0.5)), (0.25, 0.75)),
]


@pytest.mark.parametrize("phase", kinds, ids=repr)
def test_normalisation_mean_and_distribution_by_quadrature(phase):
    nodes, weights = np.polynomial.legendre.leggauss(250)
    density = 2 * np.pi * phase_pdf(phase, nodes).value
    assert density @ weights == pytest.approx(1, abs=1e-12)
    assert density @ (weights * nodes) == pytest.approx(float(phase_mean_cosine(phase).value), abs=1e-12)
    for mu in (-0.6, 0.1, 0.95):
        half = (mu + 1) / 2
        part = 2 * np.pi * half * (phase_pdf(phase, half * (nodes + 1) - 1).value @ weights)
        assert part == pytest.approx(float(phase_cdf(phase, mu).value), abs=1e-12)
    assert phase_cdf(phase, [-1.0, 1.0]).value == pytest.approx([0, 1], abs=1e-15)


SAME = [
    (Draine(0.4, 0.0), HenyeyGreenstein(0.4)),
    (Draine(-0.7, 1.0), CornetteShanks(-0.7)),
    (Draine(0.0, 1.0), Rayleigh()),
    (HenyeyGreenstein(0.0), Isotropic()),
    (Schlick(0.0), Isotropic()),
    (DoubleHenyeyGreenstein(0.3, -0.8, 1.0), HenyeyGreenstein(0.3)),
    (Mixture((Hazy(), Hazy()), (0.25, 0.75)), Hazy()),
    (Tabulated.normalised((-1, 0, 1), (3, 3, 3)), Isotropic()),
]


@pytest.mark.parametrize(("one", "other"), SAME, ids=repr)
def test_limits_of_one_kind_are_another(one, other):
    mu = np.linspace(-1, 1, 201)
    assert phase_pdf(one, mu).value == pytest.approx(phase_pdf(other, mu).value, rel=1e-14)
    assert phase_cdf(one, mu).value == pytest.approx(phase_cdf(other, mu).value, rel=1e-13)
    assert phase_quantile(one, [0.1, 0.6]).value == pytest.approx(phase_quantile(other, [0.1, 0.6]).value, abs=1e-14)


def test_published_means():
    assert phase_mean_cosine(Schlick.from_g(0.8)).value == pytest.approx(0.8726, abs=5e-5)
    assert phase_mean_cosine(Schlick.from_g(0.5)).value == pytest.approx(0.5320, abs=5e-5)
    assert phase_mean_cosine(Hazy()).value == 0.4
    assert phase_mean_cosine(Murky()).value == pytest.approx(8 / 17, abs=EPS)


def test_a_gap_in_the_density_widens_the_quantile():
    gap = Tabulated.normalised((-1, -0.25, 0.25, 1), (1, 0, 0, 1))
    across = phase_quantile(gap, 0.5)
    assert across.value - across.error <= -0.25 <= across.value + across.error
    for xi, sign in ((0.499, -1), (0.501, 1)):
        beside = phase_quantile(gap, xi)
        assert sign * beside.value > 0.25
        assert beside.error < 1e-13


def test_forward_means_positive_g():
    assert phase_pdf(HenyeyGreenstein(0.7), 1.0).value > phase_pdf(HenyeyGreenstein(0.7), -1.0).value


def test_arrays_of_any_shape():
    mu = np.linspace(-1, 1, 2 * 70_000).reshape(2, 1, 70_000)
    whole = phase_pdf(HenyeyGreenstein(0.3), mu)
    assert whole.value.shape == whole.error.shape == mu.shape
    assert whole.value[1, 0, 12] == phase_pdf(HenyeyGreenstein(0.3), mu[1, 0, 12]).value
    for function in (phase_cdf, phase_quantile):
        for phase in (Rayleigh(), Hazy()):
            assert function(phase, []).value.shape == (0,)
            assert function(phase, 0.5).value.shape == ()
            assert function(phase, [[0.5]]).error.shape == (1, 1)
    assert phase_mean_cosine(Hazy()).value.shape == ()


@pytest.mark.parametrize("function", [phase_pdf, phase_cdf])
def test_a_cosine_is_refused_beyond_rounding(function):
    for phase in (Isotropic(), HenyeyGreenstein(0.9), Murky(), Mixture((Rayleigh(),), (1,))):
        for sign in (1, -1):
            assert function(phase, sign * (1 + 2 * EPS)).value == function(phase, sign * 1.0).value
            for bad in (sign * (1 + 1e-12), sign * np.inf, np.nan, [0.5, sign * 1.5]):
                with pytest.raises(InvalidValueError, match=r"mu must be a cosine in \[-1, 1\]"):
                    function(phase, bad)
    with pytest.raises(InvalidValueError, match="phase must be a phase function"):
        function("rayleigh", 0.5)
    with pytest.raises(InvalidValueError, match="mu must be a number"):
        function(Rayleigh(), "x")


def test_a_probability_is_refused_outside_the_unit_interval():
    for bad in (-1e-300, 1 + EPS, np.nan, [0.1, 2]):
        with pytest.raises(InvalidValueError, match=r"xi must be a probability in \[0, 1\]"):
            phase_quantile(HenyeyGreenstein(0.5), bad)
