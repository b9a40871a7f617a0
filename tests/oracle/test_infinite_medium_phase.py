"""Invariant: around a point source in an infinite medium of any phase function the fluence is right within the stated error."""

import numpy as np
import pytest
from scipy.linalg import eigh_tridiagonal

from fogproof.analytic import mean_square_displacement, point_source_collisions, point_source_fluence
from fogproof.analytic.multiple import infinite_medium_phase
from fogproof.analytic.multiple.transport_poles import poles
from fogproof.scene import HenyeyGreenstein, Murky, Rayleigh, Tabulated

FAR = np.array([0.5, 2.0, 10.0, 40.0])


def spectrum(c, chi, r):
    """4 pi r phi from the eigenvalues of the equations for 1500 moments: no transform, no cut, no Legendre functions."""
    degree = np.arange(1500)
    every = np.zeros(1500)
    every[: len(chi)] = chi
    h = (2 * degree + 1) * (1 - c * every)
    nu, V = eigh_tridiagonal(np.zeros(1500), degree[1:] / np.sqrt(h[:-1] * h[1:]))
    some = nu > 1e-9
    return np.array([np.sum(2 * (V[0, some] / nu[some]) ** 2 * np.exp(-x / nu[some])) for x in r]) / h[0]


@pytest.mark.parametrize(("c", "g"), [(0.9, 0.5), (0.2, 0.8), (0.999, 0.95), (0.5, -0.7)])
def test_the_spectrum_of_moments_agrees(c, g):
    found = point_source_fluence(c, FAR, HenyeyGreenstein(g))
    truth = spectrum(c, g ** np.arange(1500.0), FAR) / (4 * np.pi * FAR)
    assert np.all(np.abs(found.value - truth) <= found.error + 1e-12 * truth)
    assert np.all(found.error <= 1e-10 * truth)


def test_almost_isotropic_scattering_is_isotropic():
    for c in (1e-3, 0.5, 0.99, 1.0):
        one, other = (point_source_fluence(c, [1e-3, 1.0, 50.0], *p) for p in ((), (HenyeyGreenstein(1e-18),)))
        assert np.all(np.abs(one.value - other.value) <= one.error + other.error)
    assert point_source_fluence(0.5, [0.0], HenyeyGreenstein(0.5)).value.tolist() == [np.inf]


def test_nothing_absorbed_is_diffusion_far_away():
    """At albedo 1 the fluence tends to 3 (1 - g)/(4 pi r), and the difference falls like exp(-r) or a slower pole."""
    found = point_source_fluence(1.0, 1e6, HenyeyGreenstein(0.6))
    assert found.value == pytest.approx(3 * 0.4 / (4 * np.pi * 1e6), rel=1e-12)


@pytest.mark.parametrize("phase", [HenyeyGreenstein(0.6), Rayleigh(), Murky()], ids=str)
def test_collisions_are_the_integral_of_the_fluence(phase):
    y, w = np.polynomial.legendre.leggauss(60)
    r, w = (1 + y) ** 2, 2 * (1 + y) * w  # up to a radius of 4
    whole = 4 * np.pi * np.sum(w * r * r * point_source_fluence(0.8, r, phase).value)
    assert point_source_collisions(0.8, 4.0, phase).value == pytest.approx(whole, rel=1e-9)
    assert point_source_collisions(0.8, 1e3, phase).value == pytest.approx(5.0, rel=1e-12)


def test_the_mean_square_of_the_distance():
    """int r^2 phi dV from the moments after each number of flights."""
    c, g = 0.7, 0.6
    r = np.exp(np.linspace(-14, 5, 800))
    fluence = point_source_fluence(c, r, HenyeyGreenstein(g)).value
    found = np.trapezoid(4 * np.pi * r**5 * fluence, np.log(r))
    collided = sum(c ** (n - 1) * float(mean_square_displacement(n, g).value) for n in range(1, 120))
    assert found == pytest.approx(collided, rel=1e-4)


def test_no_pole_is_missed():
    """As many as eigenvalues of the equations for many moments lie beyond the cut, and where they are."""
    chi = 0.9 ** np.arange(400.0)
    h = (2 * np.arange(4000) + 1) * (1 - 0.99 * 0.9 ** np.arange(4000.0))
    off = np.arange(1, 4000) / np.sqrt(h[:-1] * h[1:])
    nu = eigh_tridiagonal(np.zeros(4000), off, eigvals_only=True)
    found = poles(0.99, chi)
    assert len(found.kappa) == np.sum(nu > 1 + 1e-6)
    assert np.allclose(np.sort(1 / found.kappa), nu[nu > 1 + 1e-6], rtol=1e-11)


def test_phase_functions_with_endless_moments_say_what_that_costs(monkeypatch):
    """A table with kinks has moments that fall like a power: the error is larger, and holds for fewer of them."""
    phase = Tabulated.normalised(tuple(np.linspace(-1, 1, 5)), (0.5, 0.2, 0.3, 0.8, 3.0))
    found = []
    for most in (64, 256):
        monkeypatch.setattr(infinite_medium_phase, "MOST", most)
        infinite_medium_phase.moments_of.cache_clear()
        found.append(point_source_fluence(0.9, [0.1, 1.0, 10.0], phase))
    infinite_medium_phase.moments_of.cache_clear()
    off = np.abs(found[0].value - found[1].value)
    assert np.all(off <= found[0].error)
    assert np.any(off >= 0.01 * found[0].error)
    assert np.all(found[0].error <= 1e-4 * found[0].value)
