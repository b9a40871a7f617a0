"""Invariant: the mean over sizes is the mean over sizes, whoever sums it and in whatever order, within a bound that is small."""

import numpy as np
import pytest

from fogproof.analytic import airlight_integral, phase_cdf, phase_legendre_moments, phase_mean_cosine, phase_pdf
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators.phase import polydisperse_mie as drawn
from fogproof.oracle import answer
from fogproof.scene import Mie, PolydisperseMie, Tabulated

miepython = pytest.importorskip("miepython")

DUST = PolydisperseMie("log-normal", 0.3e-6, 0.2, 550e-9, 1.5 + 0.05j)
DROPLETS = PolydisperseMie("gamma", 0.6e-6, 0.1, 550e-9, 1.333, 1.0)
THETA = np.linspace(0, np.pi, 31)
MU = np.cos(THETA)


def _by_miepython(phase, mu):
    """The definition, with another program's phase function and cross section of one sphere and a plain sum over d."""
    a, b = phase.effective_diameter, phase.effective_variance
    d = a * np.exp(np.linspace(-5, 4, 901))
    if phase.distribution == "gamma":
        number = (d / a) ** ((1 - 3 * b) / b) * np.exp(-d / (a * b))
    else:
        median = a * (1 + b) ** -2.5
        number = np.exp(-(np.log(d / median) ** 2) / (2 * np.log(1 + b))) / d
    there = number * d**3 > 1e-16 * (number * d**3).max()
    total, cross = np.zeros_like(mu), 0.0
    for diameter, n in zip(d[there], number[there], strict=True):
        x = np.pi * diameter / phase.wavelength
        m = phase.refractive_index.conjugate()
        scattering = miepython.efficiencies_mx(m, x)[1] * diameter**2
        total += n * diameter * scattering * miepython.i_unpolarized(m, x, mu, norm="one")
        cross += n * diameter * scattering
    return total / cross


@pytest.mark.parametrize("phase", [DUST, DROPLETS], ids=lambda phase: phase.distribution)
def test_another_programs_sum_agrees(phase):
    found = phase_pdf(phase, MU)
    assert np.all(np.abs(found.value - _by_miepython(phase, MU)) <= found.error + 1e-6 * found.value)
    assert np.all(found.error <= 1e-6 * found.value)


@pytest.mark.parametrize("phase", [DUST, DROPLETS], ids=lambda phase: phase.distribution)
def test_the_sampler_has_the_same_density(phase):
    found = phase_pdf(phase, MU)
    assert np.all(np.abs(drawn.density(phase, 1 - MU, 1 + MU) - found.value) <= found.error)
    xi = np.random.default_rng(2).random(300)
    at = drawn.polar(phase, xi)
    share = phase_cdf(phase, (at.coversine - at.versine) / 2)
    assert np.all(np.abs(share.value - xi) <= share.error + 1e-9)


def test_integral_mean_and_moments_agree():
    x, w = np.polynomial.legendre.leggauss(120)
    f = phase_pdf(DUST, x)
    assert abs(2 * np.pi * w @ f.value - 1) < 1e-12
    mean = phase_mean_cosine(DUST)
    assert abs(2 * np.pi * w @ (f.value * x) - mean.value) <= 1e-12
    moments = phase_legendre_moments(DUST, 3)
    assert abs(moments.value[1] - mean.value) <= moments.error[1] + mean.error
    half = phase_cdf(DUST, 0.0)
    y = (x - 1) / 2
    assert abs(np.pi * w @ phase_pdf(DUST, y).value - half.value) <= half.error + 1e-12
    assert phase_cdf(DUST, [-1.0, 1.0]).value == pytest.approx([0, 1], abs=1e-12)


def test_spheres_of_nearly_one_size_scatter_as_one():
    narrow, one = PolydisperseMie("gamma", 0.3e-6, 1e-4, 550e-9, 1.5 + 0.05j), Mie(0.3e-6, 550e-9, 1.5 + 0.05j)
    off = np.abs(phase_pdf(narrow, MU).value / phase_pdf(one, MU).value - 1)
    assert off.max() < 0.1  # straight back, where one sphere has a deep minimum
    assert np.median(off) < 1e-3
    wide = PolydisperseMie("gamma", 0.3e-6, 4e-4, 550e-9, 1.5 + 0.05j)
    twice = np.abs(phase_pdf(wide, MU).value / phase_pdf(one, MU).value - 1)
    assert 3 < np.median(twice / off) < 5  # it is linear in the variance


def test_airlight_and_requests():
    fine = np.linspace(-1, 1, 4001)
    table = Tabulated.normalised(fine, phase_pdf(DUST, fine).value)
    one, other = (airlight_integral(0.7, 0.5, -3.0, 4.0, phase) for phase in (DUST, table))
    assert abs(one.value - other.value) < 1e-5 * one.value
    assert one.error < 1e-6 * one.value
    request = {
        "quantity": "phase_mean_cosine",
        "phase": {"kind": "polydisperse-mie", "distribution": "log-normal", "effective_diameter": 0.3e-6,
                  "effective_variance": 0.2, "wavelength": 550e-9, "refractive_index": [1.5, 0.05]},
    }  # fmt: skip
    assert answer(request)["value"] == float(phase_mean_cosine(DUST).value)


REFUSED = [
    (lambda: PolydisperseMie("normal", 1e-6, 0.1, 5e-7, 1.3), "distribution must be 'gamma' or 'log-normal'"),
    (lambda: PolydisperseMie("gamma", 0.0, 0.1, 5e-7, 1.3), "effective_diameter must be finite and > 0"),
    (
        lambda: PolydisperseMie("gamma", 1e-6, 0.6, 5e-7, 1.3),
        r"effective_variance must lie in \[1e-4, 0.5\] for a gamma",
    ),
    (lambda: PolydisperseMie("log-normal", 1e-6, 0, 5e-7, 1.3), "spheres of one size are Mie"),
    (lambda: PolydisperseMie("gamma", 1e-6, 0.1, 5e-7, 1.3 - 0.1j), "take the conjugate"),
    (lambda: PolydisperseMie("gamma", 1e-6, 0.1, -5e-7, 1.3), "wavelength must be finite and > 0"),
]


@pytest.mark.parametrize(("make", "message"), REFUSED, ids=[m for _, m in REFUSED])
def test_what_is_none_is_refused(make, message):
    with pytest.raises(InvalidValueError, match=message):
        make()


def test_too_large_spheres_are_refused():
    rain = PolydisperseMie("gamma", 1e-3, 0.1, 550e-9, 1.333)
    for ask in (lambda: phase_pdf(rain, 0.0), lambda: drawn.polar(rain, np.array([0.5]))):
        with pytest.raises(UnsupportedError, match="size parameter"):
            ask()
