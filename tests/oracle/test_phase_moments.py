"""Invariant: Legendre moments of every phase function lie within their stated errors of the truth, however they were found."""

import mpmath as mp
import numpy as np
import pytest

from fogproof.analytic import phase_cdf, phase_legendre_moments, phase_mean_cosine, phase_pdf
from fogproof.analytic.phase import fallback
from fogproof.errors import InvalidValueError
from fogproof.scene import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    Mie,
    Mixture,
    Murky,
    Rayleigh,
    Schlick,
    Tabulated,
)

CLOSED = [
    Isotropic(),
    HenyeyGreenstein(0.6),
    HenyeyGreenstein(-0.95),
    Rayleigh(),
    Hazy(),
    Murky(),
    CornetteShanks(0.7),
    Draine(-0.5, 1000.0),
]


def _moment(density, l, kinks=()):  # noqa: E741
    """The moment of a density of one formula in mu by 30-digit quadrature."""
    with mp.workdps(30):
        points = [-1, *map(mp.mpf, kinks), 1]
        return mp.quad(lambda mu: 2 * mp.pi * density(mu) * mp.legendre(l, mu), points, maxdegree=9)


def _draine(g, alpha):
    def density(mu):
        k, a = mp.mpf(g), mp.mpf(alpha)
        norm = 4 * mp.pi * (1 + a * (1 + 2 * k * k) / 3)
        return (1 - k * k) / (1 + k * k - 2 * k * mu) ** 1.5 * (1 + a * mu * mu) / norm

    return density


FORMULAS = [
    (Draine(0.7, 2.5), _draine(0.7, 2.5)),
    (CornetteShanks(-0.6), _draine(-0.6, 1)),
    (Rayleigh(), _draine(0, 1)),
    (Hazy(), lambda mu: (1 + 9 * ((1 + mu) / 2) ** 8) / (8 * mp.pi)),
    (Murky(), lambda mu: (1 + 33 * ((1 + mu) / 2) ** 32) / (8 * mp.pi)),
    (Schlick(-0.8), lambda mu: (1 - mp.mpf(0.8) ** 2) / (4 * mp.pi * (1 + mp.mpf(0.8) * mu) ** 2)),
]


@pytest.mark.parametrize(("phase", "density"), FORMULAS, ids=lambda x: repr(x) if not callable(x) else "")
def test_moments_of_formulas(phase, density):
    found = phase_legendre_moments(phase, 40)
    for l in (0, 1, 2, 7, 23, 40):  # noqa: E741
        assert abs(found.value[l] - _moment(density, l)) <= found.error[l] + 1e-18
    assert np.all(found.error < 1e-13)


@pytest.mark.parametrize("phase", CLOSED, ids=repr)
def test_the_fallback_knows_what_the_closed_forms_know(phase):
    exact, (value, error) = phase_legendre_moments(phase, 300), fallback.legendre_moments(phase, 300)
    assert np.all(np.abs(value - exact.value) <= error + exact.error)
    assert np.max(error) < 1e-12
    mu = np.concatenate([np.linspace(-1, 1, 41), [-1 + 1e-12, 1 - 1e-12]])
    right, (value, error) = phase_cdf(phase, mu), fallback.cdf(phase, mu)
    assert np.all(np.abs(value - right.value) <= error + right.error)
    assert np.max(error) < 1e-11
    mean, (value, error) = phase_mean_cosine(phase), fallback.mean_cosine(phase)
    assert abs(value - mean.value) <= error + mean.error


def test_a_peak_that_the_cosine_cannot_hold_is_counted():
    """With 1 - mu rounded to EPS the peak of g = 0.99999, 1e-10 wide, cannot be integrated: the error says so, and holds."""
    phase = HenyeyGreenstein(0.99999)
    exact, (value, error) = phase_legendre_moments(phase, 50), fallback.legendre_moments(phase, 50)
    assert np.all(np.abs(value - exact.value) <= error)
    assert 1e-9 < np.max(error) < 1e-4


def _table_moment(table, l):  # noqa: E741
    """The moment of a table by the antiderivatives of P_l and mu P_l, in 50 digits."""

    def once(k, x):
        return x if k == 0 else (mp.legendre(k + 1, x) - mp.legendre(k - 1, x)) / (2 * k + 1)

    with mp.workdps(50):
        c, f = list(map(mp.mpf, table.cosines)), list(map(mp.mpf, table.values))
        total, moment = mp.mpf(0), mp.mpf(0)
        for a, b, left, right in zip(c, c[1:], f, f[1:], strict=False):
            slope = (right - left) / (b - a)
            plain = once(l, b) - once(l, a)
            turned = [((l + 1) * once(l + 1, x) + (l * once(l - 1, x) if l else 0)) / (2 * l + 1) for x in (a, b)]
            moment += (left - slope * a) * plain + slope * (turned[1] - turned[0])
            total += (b - a) * (left + right) / 2
        return moment / total


TABLES = [
    Tabulated.normalised((-1, 1), (1, 3)),
    Tabulated.normalised((-1, -0.3, 0.2, 0.999, 1), (1, 0, 2, 5, 300)),
    Tabulated.normalised((-1, 0.4999999999, 0.5, 1), (1, 1, 8, 8)),
    Tabulated.normalised(np.concatenate([-np.cos(np.linspace(0, 2, 30)), 1 - np.geomspace(0.2, 1e-9, 10), [1]]),
                         np.concatenate([np.linspace(2, 1, 30), np.geomspace(1, 1e6, 11)])),
]  # fmt: skip


@pytest.mark.parametrize("table", TABLES, ids=lambda table: f"{len(table.cosines)} cosines")
def test_moments_of_tables_with_kinks_are_exact(table):
    found = phase_legendre_moments(table, 400)
    for l in (0, 1, 2, 3, 30, 255, 256, 400):  # noqa: E741
        assert abs(found.value[l] - _table_moment(table, l)) <= found.error[l] + 1e-40
    assert np.all(found.error < 1e-13)


def test_mixtures_and_series():
    parts = (HenyeyGreenstein(0.9), Draine(0.2, 3.0), Schlick(0.4))
    mixed = phase_legendre_moments(Mixture(parts, (0.5, 0.3, 0.2)), 64)
    means = sum(w * phase_legendre_moments(p, 64).value for w, p in zip((0.5, 0.3, 0.2), parts, strict=True))
    assert np.all(np.abs(mixed.value - means) <= mixed.error + 1e-15)
    same = phase_legendre_moments(DoubleHenyeyGreenstein(0.8, 0.8, 0.3), 64)
    assert np.all(np.abs(same.value - 0.8 ** np.arange(65)) <= same.error + 1e-18)


def test_moments_of_a_droplet_and_the_series_of_them():
    pytest.importorskip("miepython", reason="python -m pip install 'fogproof[mie]'")
    droplet = Mie(1.2e-6, 550e-9, 1.333)
    moments, mean = phase_legendre_moments(droplet, 60), phase_mean_cosine(droplet)
    assert abs(moments.value[1] - mean.value) <= moments.error[1] + mean.error
    mu = np.linspace(-1, 1, 33)
    series = np.polynomial.legendre.legval(mu, moments.value * (2 * np.arange(61) + 1) / (4 * np.pi))
    assert np.allclose(series, phase_pdf(droplet, mu).value, atol=1e-11)


def test_arguments():
    assert phase_legendre_moments(Hazy(), 0).value.tolist() == [1.0]
    for count in (-1, 1.5, True, "3"):
        with pytest.raises(InvalidValueError, match=r"count must be a whole number in \[0, 1000000\]"):
            phase_legendre_moments(Hazy(), count)
