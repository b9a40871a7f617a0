"""Invariant: what a slab reflects, transmits and emits is right within the stated error, for every thickness, albedo,
angle and phase function; the error stays below 1e-12 for isotropic scattering and 1e-10 for |g| <= 0.85."""

import json
from pathlib import Path

import flint
import numpy as np
import pytest
from doubling_truth import doubled_truth
from hypothesis import given, settings
from hypothesis import strategies as st
from transport_truth import disort, slab_truth

from fogproof.analytic import (
    half_space_brdf,
    half_space_reflectance,
    half_space_spherical_albedo,
    slab_brdf,
    slab_diffuse_reflectance,
    slab_diffuse_transmittance,
    slab_emissivity,
    slab_reflectance,
    slab_reflectance_orders,
    slab_transmittance,
    slab_transmittance_orders,
)
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import CornetteShanks, HenyeyGreenstein, Isotropic, Mixture, Rayleigh

VALUES = json.loads((Path(__file__).parents[1] / "data" / "reference-values.json").read_text())
albedos = st.one_of(st.sampled_from([0.0, 1.0]), st.floats(0, 1), st.floats(-16, 0).map(lambda x: 1 - 10.0**x))
thicknesses = st.one_of(st.just(0.0), st.floats(-12, 6).map(lambda x: 10.0**x))
cosines = st.one_of(st.just(1.0), st.floats(-6, 0).map(lambda x: 10.0**x))


def off(reference, truth):
    """By how much a Reference misses, as a share of what it promises."""
    return np.max(np.abs(reference.value - truth) / reference.error)


def slab_rows():
    for c, rows in VALUES["slab_and_sphere_isotropic"]["values"].items():
        for name, row in rows.items():
            kind, *numbers = name.split()
            if kind != "sphere":
                yield float(c), *(float(text.split("=")[1]) for text in numbers), float(row["R"]), float(row["T_total"])


@pytest.mark.parametrize("row", list(slab_rows()), ids=str)
def test_reference_values(row):
    *arguments, R, T = row
    functions = (
        (slab_reflectance, slab_transmittance)
        if len(arguments) == 3
        else (slab_diffuse_reflectance, slab_diffuse_transmittance)
    )
    for function, truth in zip(functions, (R, T), strict=True):
        reference = function(*arguments)
        assert off(reference, truth) <= 1
        assert reference.error <= 1e-12


@pytest.mark.parametrize(("c", "tau", "mu0"), [(0.9, 1e-3, 0.5), (0.5, 0.1, 0.02), (0.999, 1e-6, 1.0)])
def test_thin_slabs_and_grazing_beams(c, tau, mu0):
    R, T = slab_truth(c, tau, mu0, step=1 / 18)
    for reference, truth in ((slab_reflectance(c, tau, mu0), R), (slab_transmittance(c, tau, mu0), T)):
        assert off(reference, truth) <= 1
        assert reference.error <= 1e-12


@pytest.mark.parametrize(("g", "streams"), [(0.0, 128), (0.5, 128), (0.85, 192)])
@pytest.mark.parametrize(("c", "tau", "mu0"), [(0.9, 1.0, 0.5), (0.99, 8.0, 0.9)])
def test_another_solver_agrees(g, streams, c, tau, mu0):
    """PythonicDISORT, whose own error is what doubling its streams changes, and rounding: it writes 1 - c as a difference."""
    pytest.importorskip("PythonicDISORT")
    chi, phase = g ** np.arange(streams + 1.0), HenyeyGreenstein(g) if g else None
    coarse, fine = disort(c, tau, mu0, chi, streams // 2), disort(c, tau, mu0, chi, streams)
    for i, function in enumerate((slab_reflectance, slab_transmittance)):
        reference = function(c, tau, mu0, phase)
        assert abs(reference.value - fine[i]) <= abs(fine[i] - coarse[i]) + 3e-11 + reference.error
        assert reference.error <= 1e-10


@pytest.mark.parametrize(("g", "tau"), [(0.0, 30.0), (0.1, 3.0)])
def test_adding_layers_in_many_digits(g, tau):
    """Nearly conservative and thick, where solvers in double precision differ by 1e-9: no float is involved here."""
    truth = doubled_truth(
        0.9999, tau, 0.8, lambda degree: flint.arb(g) ** degree, n=24, moments=16 if g else 1, halvings=70
    )
    for function, value in zip((slab_reflectance, slab_transmittance), truth, strict=True):
        reference = function(0.9999, tau, 0.8, HenyeyGreenstein(g or 1e-18))
        assert abs(reference.value - value) <= reference.error + 1e-13
        assert reference.error <= 1e-13


def test_thick_and_peaked_against_frozen_digits():
    """By `doubled_truth` with 44 nodes and moments, to all 15 digits of 32: another 1e-14."""
    R, T = (function(0.9999, 30.0, 0.3, HenyeyGreenstein(0.5)) for function in (slab_reflectance, slab_transmittance))
    assert abs(R.value - 0.940306388452898) <= R.error + 1e-15 <= 1e-12
    assert abs(T.value - 0.055399427255291886) <= T.error + 1e-15 <= 1e-12


def test_a_peak_takes_more_moments():
    """PythonicDISORT with 256, 384 and 480 streams scatters by 3e-11 about this."""
    phase = HenyeyGreenstein(0.95)
    for function, truth in ((slab_reflectance, 0.0366691040257), (slab_transmittance, 0.7660090516652)):
        reference = function(0.9, 1.0, 0.5, phase)
        assert abs(reference.value - truth) <= 3e-12
        assert reference.error <= 1e-10 * reference.value


@pytest.mark.parametrize("g", ["0.5", "0.75", "0.85"])
def test_henyey_greenstein_values(g):
    row = VALUES["hg_slab_b1_c0.9_mu0.5"][g]
    for function, text in ((slab_reflectance, row["R"]), (slab_transmittance, row["T"])):
        reference = function(0.9, 1.0, 0.5, HenyeyGreenstein(float(g)))
        rounded = 10.0 ** -(len(text) - 2)  # the table agrees with its own check to 1e-11
        assert abs(reference.value - float(text)) <= reference.error + max(rounded, 1e-11)


@given(albedos, thicknesses, cosines, st.sampled_from([0.0, 0.2, -0.6, 0.8]))
@settings(max_examples=15, deadline=None)
def test_moments_reproduce_isotropic_scattering_and_nothing_is_lost(c, tau, mu0, g):
    """Two solvers that share no eigenvalue; at albedo 1 what is not reflected passes, for every phase function."""
    with np.errstate(all="raise"):
        isotropic = slab_reflectance(c, tau, mu0)
        by_moments = slab_reflectance(c, tau, mu0, HenyeyGreenstein(1e-18))
        assert abs(isotropic.value - by_moments.value) <= isotropic.error + by_moments.error
        assert isotropic.error <= 1e-12
        phase = HenyeyGreenstein(g)
        R, T, E = (f(c, tau, mu0, phase) for f in (slab_reflectance, slab_transmittance, slab_emissivity))
        for part in (R, T, E):
            assert -part.error <= part.value <= 1 + part.error
        assert R.value + T.value + E.value == pytest.approx(1, abs=1e-12)
        if c == 1:
            assert abs(E.value) <= E.error


@given(albedos, st.sampled_from([None, Rayleigh(), HenyeyGreenstein(0.5), CornetteShanks(0.4)]))
@settings(max_examples=8, deadline=None)
def test_limits_of_thickness(c, phase):
    nothing = slab_reflectance(c, 0.0, 0.3, phase)
    assert abs(nothing.value) <= nothing.error
    assert slab_transmittance(c, 0.0, 0.3, phase).value == pytest.approx(1, abs=1e-12)
    thin = slab_reflectance(c, 1e-7, 1.0, Isotropic()).value
    assert thin == pytest.approx(c * 1e-7 / 2, rel=1e-5, abs=1e-14)
    if c < 1 - 1e-3:
        thick = slab_reflectance(c, 1e4, 0.7)
        assert abs(thick.value - half_space_reflectance(c, 0.7).value) <= thick.error + 1e-14
        diffuse = slab_diffuse_reflectance(c, 1e4)
        assert abs(diffuse.value - half_space_spherical_albedo(c).value) <= diffuse.error + 1e-14


def test_a_thick_slab_without_absorption_obeys_diffusion():
    """T = (4/3)/(tau + 2 q) with Hopf's q, up to terms that vanish exponentially."""
    for tau in (50.0, 1e3, 1e6):
        reference = slab_diffuse_transmittance(1.0, tau)
        assert abs(reference.value - (4 / 3) / (tau + 2 * 0.71044608959876307)) <= reference.error


def test_anisotropy_scales_away_in_a_thick_slab():
    """Diffusion sees (1 - g) tau only, however the phase function is written."""
    mixture = Mixture((Isotropic(), HenyeyGreenstein(0.8)), (0.25, 0.75))
    for phase, g in ((HenyeyGreenstein(0.6), 0.6), (Rayleigh(), 0.0), (mixture, 0.6)):
        thick, thicker = (1 / slab_diffuse_transmittance(1.0, tau, phase).value for tau in (1e3, 2e3))
        assert thicker - thick == pytest.approx(0.75 * (1 - g) * 1e3, rel=1e-9)


@given(st.floats(0, 1), st.floats(-2, 1.5), st.floats(1, 3))
@settings(max_examples=10, deadline=None)
def test_dielectric_boundaries_keep_the_balance(c, log_tau, index):
    tau, mu0 = 10.0**log_tau, np.array([0.1, 0.6, 1.0])
    R, T, E = (f(c, tau, mu0, None, index) for f in (slab_reflectance, slab_transmittance, slab_emissivity))
    assert R.value + T.value + E.value == pytest.approx(1, abs=1e-12)
    conservative = slab_emissivity(1.0, tau, mu0, None, index)
    assert np.all(np.abs(conservative.value) <= conservative.error)
    # Without scattering it is a glass plate, seen under the refracted angle.
    plate = slab_transmittance(0.0, tau, 1.0, None, index)
    r, e = ((index - 1) / (index + 1)) ** 2, np.exp(-tau)
    assert abs(plate.value - (1 - r) ** 2 * e / (1 - (r * e) ** 2)) <= plate.error


def test_a_refractive_index_of_one_changes_nothing():
    matched, nearly = slab_reflectance(0.9, 2.0, [0.3, 1.0]), slab_reflectance(0.9, 2.0, [0.3, 1.0], None, 1 + 1e-9)
    assert matched.value == pytest.approx(nearly.value, abs=1e-8)


def test_the_error_with_a_dielectric_boundary_holds(monkeypatch):
    """More nodes do not move the solution by more than its error."""
    from fogproof.analytic.multiple import slab_by_modes

    for index in (1 + 1e-9, 1.05, 1.5, 3.0):
        for function in (slab_reflectance, slab_transmittance, slab_emissivity):
            arguments = 0.95, 1.5, np.array([1e-7, 0.05, 0.5, 1.0]), None, index
            reference = function(*arguments)
            with monkeypatch.context() as patched:
                patched.setattr(slab_by_modes, "LEVELS", (48, 64))
                assert off(reference, function(*arguments).value) <= 1
            assert np.all(reference.error <= 1e-12 * reference.value)


@pytest.mark.parametrize("phase", [None, Rayleigh(), HenyeyGreenstein(0.6)], ids=str)
def test_orders_add_up(phase):
    mu0 = np.array([[0.2], [1.0]])
    R, T = slab_reflectance_orders(1.5, mu0, 24, phase), slab_transmittance_orders(1.5, mu0, 24, phase)
    powers = 0.25 ** np.arange(25)
    for orders, whole in ((R, slab_reflectance), (T, slab_transmittance)):
        assert orders.value.shape == (2, 1, 25)
        reference = whole(0.25, 1.5, mu0, phase)
        assert np.all(
            np.abs(orders.value @ powers - reference.value) <= orders.error @ powers + reference.error + 1e-14
        )
    assert np.all(np.abs(T.value[..., 0] - np.exp(-1.5 / mu0)) <= T.error[..., 0])
    assert np.all(np.abs(R.value[..., 0]) <= R.error[..., 0])


def test_single_scattering_is_elementary():
    """R_1 = int_0^1 mu'/(mu + mu')/2 (1 - exp(-tau (1/mu + 1/mu'))) dmu' for isotropic scattering."""
    tau, mu = 0.8, 0.6
    y, w = np.polynomial.legendre.leggauss(200)
    y, w = (1 + y) / 2, w / 2
    nodes = y * y
    single = np.sum(y * w * nodes / (mu + nodes) * -np.expm1(-tau / mu - tau / nodes))
    orders = slab_reflectance_orders(tau, mu, 1)
    assert abs(orders.value[1] - single) <= orders.error[1]


def test_brdf_of_a_published_table():
    """van de Hulst 1980, Multiple Light Scattering 1, table 12: albedo 0.8, optical thickness 2, five digits of pi times it."""
    mu0 = [1.0, 0.9, 0.7, 0.5, 0.3, 0.1]
    table = [0.28616, 0.30277, 0.34188, 0.39102, 0.45353, 0.53214]
    assert np.pi * slab_brdf(0.8, 2.0, mu0, 0.5).value == pytest.approx(table, abs=0.51e-5)


@given(albedos, st.floats(-4, 4).map(lambda x: 10.0**x), st.floats(0.02, 1))
@settings(max_examples=8, deadline=None)
def test_brdf_integrates_to_the_reflectance(c, tau, mu0):
    y, w = np.polynomial.legendre.leggauss(80)
    y, w = (1 + y) / 2, w / 2
    mu, weight = y**3, 3 * y * y * w
    with np.errstate(all="raise"):
        brdf = slab_brdf(c, tau, mu0, mu)
        whole = slab_reflectance(c, tau, mu0)
    assert abs(2 * np.pi * np.sum(weight * mu * brdf.value) - whole.value) <= 1e-11
    assert brdf.value == pytest.approx(slab_brdf(c, tau, mu, mu0).value, rel=1e-10)
    assert np.all(brdf.error <= 1e-12 * brdf.value * max(1, tau) + 1e-300)


def test_brdf_of_a_thick_slab_is_that_of_the_half_space():
    mu = np.array([[0.1], [0.5], [1.0]])
    for c in (0.1, 0.9, 0.999):
        slab, half_space = slab_brdf(c, 2e3, mu, mu.T), half_space_brdf(c, mu, mu.T)
        assert np.all(np.abs(slab.value - half_space.value) <= slab.error + half_space.error)


def test_shapes_broadcast():
    reference = slab_reflectance(np.array([[0.5], [0.9]]), 1.0, np.array([0.2, 0.5, 1.0]))
    assert reference.value.shape == reference.error.shape == (2, 3)
    assert reference.value[1, 1] == pytest.approx(slab_reflectance(0.9, 1.0, 0.5).value, abs=1e-14)
    assert slab_diffuse_reflectance([0.5, 0.9], 1.0).value.shape == (2,)
    assert slab_reflectance(0.5, 1.0, 0.5).value.shape == ()


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda: slab_reflectance(-0.1, 1.0, 0.5), "albedo"),
        (lambda: slab_reflectance(0.5, np.inf, 0.5), "tau"),
        (lambda: slab_transmittance(0.5, 1.0, -0.5), "mu0"),
        (lambda: slab_reflectance(0.5, 1.0, 0.5, "isotropic"), "phase"),
        (lambda: slab_reflectance(0.5, 1.0, 0.5, None, 0.9), "refractive_index"),
        (lambda: slab_reflectance_orders([1.0, 2.0], 0.5, 3), "tau"),
        (lambda: slab_reflectance_orders(1.0, 0.5, 2.5), "count"),
    ],
)
def test_bad_arguments_are_named(call, argument):
    with pytest.raises(InvalidValueError) as raised:
        call()
    assert raised.value.argument == argument


def test_what_cannot_be_solved_is_refused():
    with pytest.raises(UnsupportedError, match="isotropic"):
        slab_reflectance(0.5, 1.0, 0.5, HenyeyGreenstein(0.3), 1.5)
