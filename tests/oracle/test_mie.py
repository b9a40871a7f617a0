"""Invariant: the Lorenz-Mie phase function of a sphere is within its stated error, for drops of 1, 10 and 100 um and for
spheres as small as Rayleigh's; and it shows what it was made to explain, the forward peak and the rainbow.

The truth sums the series of Bohren & Huffman (eq. 4.53, with derivatives of the Riccati-Bessel functions, not the
logarithmic ones) at as many digits as its cancellations cost.
"""

import sys

import mpmath as mp
import numpy as np
import pytest
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from fogproof.analytic import (
    phase_cdf,
    phase_mean_cosine,
    phase_pdf,
    phase_quantile,
    rayleigh_scattering_coefficient,
)
from fogproof.analytic.phase import mie as phase_mie
from fogproof.errors import NotInstalledError, UnsupportedError
from fogproof.scene import Mie, Rayleigh

miepython = pytest.importorskip("miepython", reason="python -m pip install 'fogproof[mie]'")

EPS = 2.0**-52
GREEN = 550e-9
WATER = 1.333


def riccati_bessel(z, order):
    psi = [mp.sin(z), mp.sin(z) / z - mp.cos(z)]
    chi = [mp.cos(z), mp.cos(z) / z + mp.sin(z)]
    for n in range(1, order + 1):
        psi.append((2 * n + 1) / z * psi[n] - psi[n - 1])
        chi.append((2 * n + 1) / z * chi[n] - chi[n - 1])
    return psi, chi


def derivative(f, n, z):
    return f[n - 1] - n / z * f[n]


def true_coefficients(sphere):
    size = np.pi * sphere.diameter * sphere.medium_index / sphere.wavelength
    order = int(size + 9 * size ** (1 / 3) + 12)
    with mp.workdps(60 + int(0.6 * order - 30 * np.log10(min(size, 1)))):
        x = mp.pi * mp.mpf(sphere.diameter) * mp.mpf(sphere.medium_index) / mp.mpf(sphere.wavelength)
        m = mp.mpc(sphere.refractive_index) / mp.mpf(sphere.medium_index)
        z = m * x
        (psi, chi), (inner, _) = riccati_bessel(x, order), riccati_bessel(z, order)
        xi = [p - 1j * c for p, c in zip(psi, chi, strict=True)]
        a, b = [], []
        for n in range(1, order + 1):
            dpsi, dxi, dinner = derivative(psi, n, x), derivative(xi, n, x), derivative(inner, n, z)
            a.append((m * inner[n] * dpsi - psi[n] * dinner) / (m * inner[n] * dxi - xi[n] * dinner))
            b.append((inner[n] * dpsi - m * psi[n] * dinner) / (inner[n] * dxi - m * xi[n] * dinner))
    return [+c for c in a], [+c for c in b]


def true_pdf(coefficients, mu):
    a, b = coefficients
    norm = 4 * mp.pi * sum((2 * n + 1) * (abs(a[n - 1]) ** 2 + abs(b[n - 1]) ** 2) for n in range(1, len(a) + 1))
    S1 = S2 = before = mp.mpf(0)
    pi = mp.mpf(1)
    for n in range(1, len(a) + 1):
        tau = n * mu * pi - (n + 1) * before
        scale = mp.mpf(2 * n + 1) / (n * (n + 1))
        S1 += scale * (a[n - 1] * pi + b[n - 1] * tau)
        S2 += scale * (a[n - 1] * tau + b[n - 1] * pi)
        before, pi = pi, ((2 * n + 1) * mu * pi - (n + 1) * before) / n
    return (abs(S1) ** 2 + abs(S2) ** 2) / norm


def true_mean_cosine(coefficients):
    a, b = coefficients
    same = sum(mp.mpf(2 * n + 1) / (n * (n + 1)) * (a[n - 1] * mp.conj(b[n - 1])).real for n in range(1, len(a) + 1))
    step = sum(
        mp.mpf(n * (n + 2)) / (n + 1) * (a[n - 1] * mp.conj(a[n]) + b[n - 1] * mp.conj(b[n])).real
        for n in range(1, len(a))
    )
    return (
        2 * (same + step) / sum((2 * n + 1) * (abs(a[n - 1]) ** 2 + abs(b[n - 1]) ** 2) for n in range(1, len(a) + 1))
    )


def assert_pdf(sphere, cosines):
    with mp.workdps(40):
        coefficients = true_coefficients(sphere)
        result = phase_pdf(sphere, cosines)
        for mu, value, error in zip(cosines, result.value, result.error, strict=True):
            truth = true_pdf(coefficients, mp.mpf(float(mu)))
            assert abs(mp.mpf(float(value)) - truth) <= error, (sphere, mu, mp.nstr(truth, 17), value, error)
            assert error <= 1e-6 * truth
        mean = phase_mean_cosine(sphere)
        assert abs(mp.mpf(float(mean.value)) - true_mean_cosine(coefficients)) <= float(mean.error)


indices = st.one_of(
    st.floats(1.01, 2.5),
    st.floats(0.5, 0.99),
    st.floats(-6, -2).map(lambda e: 1 + 10.0**e),
    st.builds(complex, st.floats(0.2, 3), st.floats(-8, 0.5).map(lambda e: 10.0**e)),
)


@settings(max_examples=60, deadline=None)
@given(
    size=st.floats(-3, 1.2).map(lambda e: 10.0**e),
    index=indices,
    medium=st.sampled_from([1.0, 1.33]),
    mu=st.lists(st.floats(-1, 1), min_size=1, max_size=3),
)
def test_density_is_within_its_error(size, index, medium, mu):
    assert_pdf(Mie(size * GREEN / np.pi / medium, GREEN, index * medium, medium), mu)


DROPS = [Mie(d, GREEN, n) for d in (1e-6, 10e-6, 100e-6) for n in (WATER, WATER + 0.01j)]


@pytest.mark.parametrize("drop", DROPS, ids=repr)
def test_drops_of_the_lecture(drop):
    assert_pdf(drop, [-1.0, -0.75, 0.3, 0.99999, 1.0])


def gauss_legendre(n):
    """Nodes and weights to the last bit: those of numpy and scipy are off by up to 1e-9 for n = 700."""
    with ctx.workprec(100):
        roots = [arb.legendre_p_root(n, k, weight=True) for k in range(n)]
        return np.array([[float(node), float(weight)] for node, weight in roots]).T


@pytest.mark.parametrize("drop", DROPS, ids=repr)
def test_normalisation_mean_and_distribution_by_quadrature(drop):
    """Gauss-Legendre is exact for the polynomial that the density is; miepython has its own sum for g."""
    nodes, weights = gauss_legendre(phase_mie._series(drop).n.size + 1)
    density = phase_pdf(drop, nodes)
    # Rounding of the nodes moves them by EPS/4 in a forward peak of width 1/x^2 in mu.
    slack = 2 * np.pi * (density.error @ weights) + EPS * (100 + (np.pi * drop.diameter / GREEN) ** 2 / 4)
    assert 2 * np.pi * (density.value @ weights) == pytest.approx(1, abs=slack)
    mean = phase_mean_cosine(drop)
    assert 2 * np.pi * (density.value @ (weights * nodes)) == pytest.approx(float(mean.value), abs=slack)
    assert miepython.efficiencies(drop.refractive_index, drop.diameter, GREEN)[3] == pytest.approx(mean.value, abs=1e-9)
    for mu in (-0.9, 0.2, 0.999):
        half = (mu + 1) / 2
        part = 2 * np.pi * half * (phase_pdf(drop, half * (nodes + 1) - 1).value @ weights)
        cdf = phase_cdf(drop, mu)
        assert part == pytest.approx(float(cdf.value), abs=slack + float(cdf.error))
        assert cdf.error < 1e-10
    assert phase_cdf(drop, [-1.0, 1.0]).value == pytest.approx([0, 1], abs=1e-11)


def test_quantile_inverts_the_distribution():
    xi = np.linspace(0, 1, 41)
    mu = phase_quantile(DROPS[2], xi)
    back = phase_cdf(DROPS[2], mu.value)
    slope = 2 * np.pi * phase_pdf(DROPS[2], mu.value).value
    assert (np.abs(back.value - xi) <= back.error + 2 * slope * mu.error).all()
    assert np.median(mu.error) < 1e-11


def test_small_spheres_scatter_as_rayleigh():
    """The density departs from Rayleigh's by O(x^2), the scattering cross section from the closed form likewise."""
    mu, previous = np.linspace(-1, 1, 21), None
    for x in (0.1, 0.01, 0.001):
        d = x * GREEN / np.pi
        off = np.abs(phase_pdf(Mie(d, GREEN, WATER), mu).value / phase_pdf(Rayleigh(), mu).value - 1).max()
        assert off < x * x
        if previous is not None:
            assert previous / off == pytest.approx(100, rel=0.05)
        previous = off
    for x in (0.029, 0.29):
        d = x * GREEN / np.pi
        for index in (WATER, 1.5 + 0.3j):
            q_sca = miepython.efficiencies(index, d, GREEN)[1]
            coefficient = rayleigh_scattering_coefficient(d, index, 2.5e25, GREEN).value
            assert q_sca * np.pi * d**2 / 4 * 2.5e25 == pytest.approx(coefficient, rel=0.3 * x * x)


def mean_intensity(diameter, wavelength, index, theta):
    """Averaged over 3 % of sizes either way, which washes out the ripple of a single drop but not the bow."""
    sizes = diameter * np.linspace(0.97, 1.03, 13)
    return np.mean([phase_pdf(Mie(d, wavelength, index), np.cos(theta)).value for d in sizes], axis=0)


def test_the_primary_rainbow_is_where_airy_puts_it():
    """Descartes: 137.9 degrees for n = 1.333. Airy: the main peak lies beyond by 1.0874 (h pi^2/12)^(1/3) x^(-2/3)."""
    wavelength, n = 650e-9, WATER
    incidence = np.arccos(np.sqrt((n * n - 1) / 3))
    geometric = np.degrees(np.pi + 2 * incidence - 4 * np.arcsin(np.sin(incidence) / n))
    assert geometric == pytest.approx(137.92, abs=0.01)
    h = 9 / 4 * np.sqrt((4 - n * n) / (n * n - 1) ** 3)
    theta = np.radians(np.linspace(135, 146, 551))
    for diameter in (100e-6, 300e-6):
        airy = np.degrees(1.0874 * (h * np.pi**2 / 12) ** (1 / 3) * (np.pi * diameter / wavelength) ** (-2 / 3))
        peak = np.degrees(theta[mean_intensity(diameter, wavelength, n, theta).argmax()])
        assert peak - geometric == pytest.approx(airy, rel=0.2)
    red = peak
    blue = np.degrees(theta[mean_intensity(diameter, 450e-9, 1.3405, theta).argmax()])
    assert blue > red + 0.5  # red is the outer colour of the bow, at the smaller scattering angle


def test_larger_drops_have_a_narrower_forward_peak():
    forward = [float(phase_pdf(drop, 1.0).value) for drop in DROPS[::2]]
    assert forward[0] < forward[1] / 30 < forward[2] / 2000
    # Fraunhofer diffraction carries half of the light, and 84 % of it lies inside the first dark ring.
    ring = np.cos(1.22 * GREEN / 100e-6)
    assert 1 - phase_cdf(DROPS[4], ring).value == pytest.approx(0.84 / 2, abs=0.03)


def test_sizes_out_of_reach_are_refused():
    for diameter in (1e-14, 1e-1):
        with pytest.raises(UnsupportedError, match="size parameters"):
            phase_pdf(Mie(diameter, GREEN, WATER), 0.5)


def test_what_to_install_is_said(monkeypatch):
    monkeypatch.setitem(sys.modules, "miepython", None)
    with pytest.raises(NotInstalledError, match=r"pip install 'fogproof\[mie\]'"):
        phase_pdf(Mie(1.2345e-6, GREEN, WATER), 0.5)
