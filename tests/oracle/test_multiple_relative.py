"""Invariant: thin, deep, nearly conservative and grazing slabs keep their digits: every error is relative and holds, no value
is negative, and without scattering it is Beer-Lambert."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from transport_truth import slab_truth

from fogproof.analytic import (
    slab_diffuse_reflectance,
    slab_diffuse_transmittance,
    slab_emissivity,
    slab_reflectance,
    slab_transmittance,
)
from fogproof.scene import CornetteShanks, HenyeyGreenstein, Rayleigh

DIRECTIONAL = (slab_reflectance, slab_transmittance, slab_emissivity)
albedos = st.one_of(
    st.sampled_from([0.0, 1.0]),
    st.floats(0, 1),
    st.floats(-16, 0).map(lambda x: 1 - 10.0**x),
    st.floats(-300, 0).map(lambda x: 10.0**x),
)
thicknesses = st.one_of(st.just(0.0), st.floats(-300, 3).map(lambda x: 10.0**x))
cosines = st.one_of(st.just(1.0), st.floats(-20, 0).map(lambda x: 10.0**x))
ALMOST_ISOTROPIC = HenyeyGreenstein(1e-18)
"""Isotropic to the last digit, but solved by doubling."""


@pytest.mark.parametrize(
    ("c", "tau", "mu0"),
    [
        (0.5, 75.0, 1.0),
        (0.9, 50.0, 1.0),
        (0.99, 300.0, 0.2),
        (0.9, 1e-9, 0.7),
        (0.2, 1.0, 1e-4),
        (1e-6, 0.3, 0.5),
        (1 - 2.0**-53, 1e4, 0.05),
    ],
)
def test_many_digit_arithmetic(c, tau, mu0):
    truth = slab_truth(c, tau, mu0, step=1 / 16)
    for function, true in zip(DIRECTIONAL, truth, strict=False):
        reference = function(c, tau, mu0)
        assert abs(reference.value - true) <= reference.error + 2e-15 * true  # of which the truth is rounded once
        assert reference.error <= 1e-12 * true


@given(albedos, thicknesses, cosines)
@settings(max_examples=10, deadline=None)
def test_modes_and_doubling_agree_in_relative_terms(c, tau, mu0):
    """Two ways that share the nodes at most: roots of the dispersion relation, and layers put on one another."""
    with np.errstate(all="raise", under="ignore"):
        for function in DIRECTIONAL:
            modes, doubling = function(c, tau, mu0), function(c, tau, mu0, ALMOST_ISOTROPIC)
            assert abs(modes.value - doubling.value) <= modes.error + doubling.error
            assert min(modes.value, doubling.value) >= 0
            assert modes.error <= 1e-12 * modes.value + 6 * 2.0**-1074
            assert doubling.error <= 1e-10 * doubling.value + 6 * 2.0**-1074


@pytest.mark.parametrize("phase", [None, Rayleigh(), HenyeyGreenstein(0.8), HenyeyGreenstein(0.99)], ids=str)
@pytest.mark.parametrize("tau", [0.0, 1e-300, 1e-5, 1.0, 40.0, 700.0])
def test_beer_lambert_is_exact(phase, tau):
    reference = slab_transmittance(0.0, tau, 0.99, phase)
    assert reference.value == pytest.approx(np.exp(-tau / 0.99), rel=3e-16 * max(1, tau))
    assert reference.error <= 2e-15 * reference.value
    assert slab_reflectance(0.0, tau, 0.99, phase).value == 0


def test_deep_slabs_transmit_more_than_beer_lambert():
    for c in (1e-9, 0.5, 0.99):
        tau = np.geomspace(1, 1e5, 20)
        reference = slab_transmittance(c, tau, 1.0)
        assert np.all(reference.value >= np.exp(-tau) * (1 - 1e-15))
        assert np.all(reference.error <= 1e-12 * reference.value + 6 * 2.0**-1074)


def test_peaked_phase_functions_have_an_honest_error():
    """Nearly all is scattered straight on: what is left is the slab of (1 - g) times the scattering, at most."""
    for g in (0.9999, 0.99999, 1 - 1e-12):
        R, T, E = (f(0.9, 1.0, 0.5, HenyeyGreenstein(g)) for f in DIRECTIONAL)
        assert 0 < R.value <= 2 * (1 - g)
        assert abs(T.value - np.exp(-0.1 / 0.5)) <= 10 * (1 - g) + 1e-12
        assert abs(R.value + T.value + E.value - 1) <= 1e-12
        assert R.error < R.value


@pytest.mark.parametrize("index", [1 + 1e-12, 1.33, 2.5])
def test_refraction_at_grazing_angles(index):
    """Towards grazing both what enters and what leaves vanish like the cosine."""
    mu0 = np.array([1e-18, 1e-15, 1e-12]) * np.sqrt(index - 1)
    for function in (slab_transmittance, slab_emissivity):
        reference = function(0.5, 1.0, mu0, None, index)
        assert np.all(reference.error <= 1e-12 * reference.value)
        assert reference.value / mu0 == pytest.approx(np.full(3, reference.value[0] / mu0[0]), rel=1e-9)


@pytest.mark.parametrize("phase", [None, HenyeyGreenstein(0.5)], ids=str)
def test_nothing_asked_nothing_answered(phase):
    for function in DIRECTIONAL:
        assert function(0.5, np.empty((3, 0)), 0.5, phase).value.shape == (3, 0)
    for function in (slab_diffuse_reflectance, slab_diffuse_transmittance):
        assert function(np.empty(0), 1.0, phase).error.shape == (0,)


def test_many_at_once_are_what_each_is_alone():
    c, tau, mu0 = np.array([0.0, 0.3, 1.0])[:, None, None], np.array([1e-4, 1.0, 1e3])[:, None], np.array([0.05, 1.0])
    for phase in (None, CornetteShanks(0.3)):
        together = slab_reflectance(c, tau, mu0, phase)
        alone = [slab_reflectance(a, b, m, phase) for a in c[:, 0, 0] for b in tau[:, 0] for m in mu0]
        value, error = (np.reshape([getattr(x, name) for x in alone], (3, 3, 2)) for name in ("value", "error"))
        assert np.all(np.abs(together.value - value) <= together.error + error)
