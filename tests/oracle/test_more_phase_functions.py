"""Invariant: von Mises-Fisher, fitted droplets and Legendre series are their textbook formulas, to errors that are small.

The truth is written in 60 digits, by formulas that cancel where ours do not.
"""

import mpmath as mp
import numpy as np
import pytest

from fogproof.analytic import (
    airlight_integral,
    phase_cdf,
    phase_legendre_moments,
    phase_mean_cosine,
    phase_pdf,
    phase_quantile,
    slab_emissivity,
)
from fogproof.analytic.phase.approximate_mie import lobes
from fogproof.errors import InvalidValueError
from fogproof.estimators.phase import approximate_mie, legendre_series, von_mises_fisher
from fogproof.oracle import answer
from fogproof.scene import ApproximateMie, Draine, HenyeyGreenstein, LegendreSeries, Mie, Mixture, VonMisesFisher

KAPPAS = [1e-12, 1e-3, 0.3, 3.0, -3.0, 30.0, -401.0, 1e5]
MU = np.concatenate([np.linspace(-1, 1, 17), 1 - np.geomspace(1e-15, 1e-2, 6), np.geomspace(1e-15, 1e-2, 6) - 1])
XI = np.array([0.0, 1e-300, 1e-12, 0.01, 0.3, 0.5, 0.7, 0.99, 1 - 2**-53, 1.0])


def off(found, right):
    """The worst share of the stated error that is used."""
    pairs = zip(np.ravel(found.value), np.ravel(found.error), right, strict=True)
    return max(float(abs(mp.mpf(v) - r) / mp.mpf(e)) if e else float(v != r) for v, e, r in pairs)


@pytest.mark.parametrize("kappa", KAPPAS)
def test_von_mises_fisher(kappa):
    phase, k = VonMisesFisher(kappa), mp.mpf(kappa)
    with mp.workdps(800):
        density = [k * mp.exp(k * m) / (4 * mp.pi * mp.sinh(k)) for m in map(mp.mpf, MU)]
        share = [(mp.exp(k * m) - mp.exp(-k)) / (2 * mp.sinh(k)) for m in map(mp.mpf, MU)]
        quantile = [mp.log(x * mp.exp(k) + (1 - x) * mp.exp(-k)) / k for x in map(mp.mpf, XI)]
        moments = [mp.mpf(1), mp.coth(k) - 1 / k]
        for l in range(1, 24):  # noqa: E741
            moments.append(moments[l - 1] - (2 * l + 1) / k * moments[l])
    assert off(phase_pdf(phase, MU), density) < 1
    assert off(phase_cdf(phase, MU), share) < 1
    found = phase_quantile(phase, XI)
    assert off(found, quantile) < 1
    assert found.error.max() < 1e-14
    found = phase_legendre_moments(phase, 24)
    assert off(found, moments) < 1
    assert np.all(found.error <= 1e-12 * np.abs(found.value) + 1e-300)
    assert off(phase_mean_cosine(phase), moments[1:2]) < 1
    assert np.all(phase_pdf(phase, MU).error <= (6 + 4 * abs(kappa)) * 3e-16 * phase_pdf(phase, MU).value + 1e-300)


@pytest.mark.parametrize("kappa", [1e-12, 0.3, -6.0, 300.0])
def test_von_mises_fisher_directions(kappa):
    """The sampler inverts the distribution, near the antipode with digits of its own."""
    phase, k = VonMisesFisher(kappa), mp.mpf(kappa)
    xi = np.concatenate([np.random.default_rng(5).random(40), [1e-9, 1 - 1e-9]])
    at = von_mises_fisher.polar(phase, xi)
    with mp.workdps(300):
        for x, v, c in zip(xi, at.versine, at.coversine, strict=True):
            mu = mp.log(mp.mpf(x) * mp.exp(k) + (1 - mp.mpf(x)) * mp.exp(-k)) / k
            assert abs(v - (1 - mu)) <= 1e-13 * (1 - mu) + 1e-16 * (1 + mu)
            assert abs(c - (1 + mu)) <= 1e-13 * (1 + mu) + 3e-16
    assert np.all(von_mises_fisher.polar(phase, np.array([0.0])).versine == 2 if kappa > 0 else True)
    flat = von_mises_fisher.polar(VonMisesFisher(5e-324), xi)
    assert np.allclose(flat.pdf, 0.25 / np.pi, rtol=1e-15)
    for rigorous in (False, True):
        both = [airlight_integral(0.7, 0.5, -3.0, 4.0, phase, rigorous=r) for r in (False, True)]
        assert abs(both[0].value - both[1].value) <= both[0].error + both[1].error
        assert both[rigorous].error < 1e-12 * both[rigorous].value


def _series(kind, order):
    if kind == "square":
        c = np.random.default_rng(order).normal(size=order // 2 + 1)
        beta = np.polynomial.legendre.legmul(c, c)
        return LegendreSeries.from_coefficients(beta / beta[0])
    return LegendreSeries(tuple((0.3 ** np.arange(order + 1)).tolist()))


SERIES = [
    _series("square", 2),
    _series("square", 12),
    _series("square", 30),
    _series("powers", 40),
    LegendreSeries((1,)),
]


@pytest.mark.parametrize("phase", SERIES, ids=lambda phase: len(phase.moments))
def test_legendre_series(phase):
    order = len(phase.moments) - 1
    with mp.workdps(60):
        chi, orders = [mp.mpf(x) for x in phase.moments], range(1, order + 1)
        density, share = [], []
        for m in map(mp.mpf, MU):
            P = [mp.mpf(1), m]
            for n in range(1, order + 1):
                P.append(((2 * n + 1) * m * P[n] - n * P[n - 1]) / (n + 1))
            density.append((1 + sum((2 * n + 1) * chi[n] * P[n] for n in orders)) / (4 * mp.pi))
            share.append((1 + m + sum(chi[n] * (P[n + 1] - P[n - 1]) for n in orders)) / 2)
    found = phase_pdf(phase, MU)
    assert off(found, density) < 1
    assert found.error.max() <= (3 + order / 8) * 2.0**-54 * np.abs(
        (2 * np.arange(order + 1) + 1) @ np.abs(phase.moments)
    )
    assert off(phase_cdf(phase, MU), share) < 1
    own = legendre_series.density(phase, 1 - MU, 1 + MU)
    assert np.max(np.abs(own - found.value)) < 1e-13 * (1 + order**1.5) * max(found.value.max(), 1)
    xi = np.random.default_rng(3).random(200)
    at = legendre_series.polar(phase, xi)
    assert np.max(np.abs(phase_cdf(phase, (at.coversine - at.versine) / 2).value - xi)) < 1e-13
    assert np.array_equal(phase_legendre_moments(phase, order + 1).value[:-1], phase.moments)
    assert phase_legendre_moments(phase, order + 1).value[-1] == 0
    proven, quick = (airlight_integral(0.7, 0.5, -3.0, 4.0, phase, rigorous=r) for r in (True, False))
    assert abs(quick.value - proven.value) <= quick.error
    assert quick.error < 1e-11 * quick.value


def test_a_long_series_is_the_function_it_was_cut_from():
    """Henyey-Greenstein by its moments: values, and what slabs make of it."""
    g, count = 0.6, 70
    phase = LegendreSeries(tuple((g ** np.arange(count + 1)).tolist()))
    right = phase_pdf(HenyeyGreenstein(g), MU).value
    assert np.max(np.abs(phase_pdf(phase, MU).value - right)) < 3 * (2 * count) * g**count
    one, other = (slab_emissivity(0.9, 1.0, 0.6, p) for p in (phase, HenyeyGreenstein(g)))
    assert abs(one.value - other.value) <= one.error + other.error + 1e-10


FITTED = [0.02, 0.1, 0.5, 1.5, 2.0, 5.0, 12.0, 50.0]


@pytest.mark.parametrize("micrometres", FITTED)
def test_fitted_droplets(micrometres):
    """Both sides have the same two lobes, from formulas written differently; and their mixture is what is answered."""
    phase = ApproximateMie(micrometres * 1e-6)
    (w0, one), (w1, other) = approximate_mie.parts(phase)
    g, g_draine, alpha, w = lobes(micrometres * 1e-6 * 1e6)
    assert np.allclose([one.g, other.g, other.alpha, w0, w1], [g, g_draine, alpha, 1 - w, w], rtol=1e-12, atol=1e-15)
    assert 0 < w < 1
    mixture = Mixture((HenyeyGreenstein(g), Draine(g_draine, alpha)), (1 - w, w))
    assert np.allclose(phase_pdf(phase, MU).value, phase_pdf(mixture, MU).value, rtol=1e-10)


def test_fitted_droplets_resemble_the_exact_ones():
    """Tiny ones scatter as Rayleigh's, those of clouds with the mean cosine of Lorenz-Mie."""
    pytest.importorskip("miepython", reason="python -m pip install 'fogproof[mie]'")
    rayleigh = 3 / (16 * np.pi) * (1 + MU**2)
    assert np.allclose(phase_pdf(ApproximateMie(1e-9), MU).value, rayleigh, rtol=0.01)
    exact = [phase_mean_cosine(Mie(12e-6 * s, 550e-9, 1.333)).value for s in (0.95, 1.0, 1.05)]
    assert abs(phase_mean_cosine(ApproximateMie(12e-6)).value - np.mean(exact)) < 0.02


def test_requests():
    for table in (
        {"kind": "von-mises-fisher", "kappa": 3},
        {"kind": "approximate-mie", "diameter": 1e-5},
        {"kind": "legendre-series", "moments": [1, 0.5, 0.2]},
    ):
        assert answer({"quantity": "phase_pdf", "phase": table, "mu": 0.5})["value"] > 0


HG16 = 0.85 ** np.arange(17)

REFUSED = [
    (lambda: VonMisesFisher(np.inf), r"kappa must lie in \[-1e15, 1e15\], got inf; a narrower peak is a delta"),
    (lambda: VonMisesFisher("sharp"), "kappa must be a number"),
    (
        lambda: ApproximateMie(60e-6),
        r"diameter must lie in \(0, 5e-05\] \[m\], got 6e-05; the fit ends at 50 micrometres",
    ),
    (lambda: ApproximateMie(10), r"got 10.0; the fit ends at 50 micrometres, and a micrometre is 1e-6 m"),
    (lambda: ApproximateMie(0.0), r"diameter must lie in \(0, 5e-05\]"),
    (lambda: LegendreSeries((0.5, 0.1)), "moments must begin with chi_0 = 1, got 0.5; divide all"),
    (lambda: LegendreSeries((1, 2.55)), r"moments must lie in \[-1, 1\], got 2.55; with the factor 2 l \+ 1 use"),
    (lambda: LegendreSeries(HG16), r"nowhere negative \(at mu = -0.974752 it is -0.0341/sr\).*take more moments"),
    (lambda: LegendreSeries(()), "moments must be a list of 1 to 2001 numbers"),
    (lambda: LegendreSeries(((1, 0), (0, 1))), "moments must be a list of 1 to 2001 numbers"),
    (lambda: LegendreSeries((1, np.nan)), r"moments must lie in \[-1, 1\], got nan"),
    (lambda: LegendreSeries.from_coefficients((1, 3.1)), r"coefficients must lie in \[-\(2 l \+ 1\)"),
    (lambda: LegendreSeries.from_coefficients((1, 2.9)), "moments must make a series that is nowhere negative"),
]


@pytest.mark.parametrize(("make", "message"), REFUSED, ids=[m for _, m in REFUSED])
def test_what_is_none_is_refused(make, message):
    with pytest.raises(InvalidValueError, match=message):
        make()


@pytest.mark.parametrize("depth", [1e-2, 1e-4, 1e-9])
def test_a_narrow_dip_below_zero_is_found(depth):
    """(mu - 0.3)^2 times a square, less a little: negative on an interval as narrow as the depth is small."""
    c = np.polynomial.legendre.legmul([-0.3, 1], np.random.default_rng(1).normal(size=30))
    beta = np.polynomial.legendre.legmul(c, c)
    assert LegendreSeries.from_coefficients(beta / beta[0])
    lower = beta - depth * beta[0] * np.eye(1, beta.size)[0]
    with pytest.raises(InvalidValueError, match="nowhere negative"):
        LegendreSeries.from_coefficients(lower / lower[0])
