"""Invariant: what delta-M leaves has the moments it says, and transports what the whole phase function does."""

import mpmath as mp
import numpy as np
import pytest

from fogproof.analytic import delta_m, delta_m_moments, phase_legendre_moments, slab_reflectance
from fogproof.errors import FogproofError, InvalidValueError, UnsupportedError
from fogproof.oracle import answer
from fogproof.scene import (
    Draine,
    ExponentialMedium,
    FournierForand,
    HenyeyGreenstein,
    Isotropic,
    Medium,
    Rayleigh,
    VonMisesFisher,
)

PHASES = [HenyeyGreenstein(0.85), HenyeyGreenstein(-0.9), Draine(0.7, 2.0), FournierForand(1.1, 3.6), Rayleigh()]


@pytest.mark.parametrize("phase", PHASES, ids=repr)
def test_with_the_delta_the_moments_are_those_of_the_phase_function(phase):
    for count in (1, 2, 7, 32):
        chi, left = phase_legendre_moments(phase, count), delta_m_moments(phase, count)
        share = chi.value[-1]
        assert left.value.shape == (count,)
        assert np.all(np.abs(share + (1 - share) * left.value - chi.value[:-1]) <= left.error + chi.error[:-1] + 1e-15)


def test_values_of_a_closed_form():
    g, count = mp.mpf(0.85), 16
    found = delta_m_moments(HenyeyGreenstein(0.85), count)
    right = [(g**l - g**count) / (1 - g**count) for l in range(count)]  # noqa: E741
    assert all(abs(v - r) <= e for v, r, e in zip(found.value, right, found.error, strict=True))
    assert found.error.max() < 1e-14


def reflectance(medium):
    depth = 2.0 * float(medium.sigma_t)
    found = slab_reflectance(float(medium.albedo), depth, 0.6, phase=medium.phase)
    return float(found.value), float(found.error)


def test_a_slab_reflects_nearly_what_it_did():
    """And not what it would with the phase function alone truncated, or with the absorption scaled too."""
    medium = Medium(0.05, 0.95, HenyeyGreenstein(0.5))
    right, error = reflectance(medium)
    offs = [abs(reflectance(delta_m(medium, count))[0] - right) for count in (3, 6, 12)]
    assert error < 1e-6
    assert offs[0] < 2e-3
    assert offs[2] < 1e-5
    assert offs[0] > offs[1] > offs[2]
    cut = delta_m(medium, 3)
    for wrong in (Medium(0.05, 0.95, cut.phase), Medium(0.05 * cut.sigma_s / 0.95, cut.sigma_s, cut.phase)):
        assert abs(reflectance(wrong)[0] - right) > 5 * offs[0]


def test_colours_and_absorption_are_kept():
    medium = delta_m(Medium((0.1, 0.2), (0.9, 0.8), VonMisesFisher(3.0)), 8)
    share = phase_legendre_moments(VonMisesFisher(3.0), 8).value[-1]
    assert medium.sigma_a == (0.1, 0.2)
    assert np.allclose(medium.sigma_s, np.array([0.9, 0.8]) * (1 - share), rtol=1e-15)
    same = delta_m(Medium(0.1, 0.9, Rayleigh()), 4)
    assert (same.sigma_s, same.phase.moments[2]) == (0.9, pytest.approx(0.1))


REFUSED = [
    (
        lambda: delta_m(Medium(0, 1, HenyeyGreenstein(0.95)), 8),
        "count must leave a phase function that is nowhere negative",
    ),
    (lambda: delta_m(Medium(0, 1, Isotropic()), 0), "count must be at least 1, got 0"),
    (lambda: delta_m_moments(Isotropic(), 1.5), "count must be a whole number"),
    (
        lambda: delta_m(ExponentialMedium(1.0, (0, 0, 0.1)), 4),
        "delta-M truncates a homogeneous Medium, not ExponentialMedium",
    ),
    (lambda: delta_m_moments(VonMisesFisher(1e15), 1), "count must leave something beside the delta"),
]


@pytest.mark.parametrize(("make", "message"), REFUSED, ids=[m for _, m in REFUSED])
def test_what_cannot_be_truncated_is_refused(make, message):
    with pytest.raises((InvalidValueError, UnsupportedError), match=message) as caught:
        make()
    assert isinstance(caught.value, FogproofError)


def test_requests():
    found = answer({"quantity": "delta_m_moments", "phase": {"kind": "henyey-greenstein", "g": 0.5}, "count": 2})
    assert found["value"] == pytest.approx([1, 1 / 3])
