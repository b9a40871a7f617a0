"""Directions that are found by inverting a distribution have the share that their uniform is, to the last digits at either pole."""

import mpmath as mp
import numpy as np
import pytest
from numpy.polynomial import chebyshev

from fogproof.estimators.phase import cosine_series, fournier_forand
from fogproof.scene.phase import FournierForand

XI = np.concatenate([np.linspace(0.001, 0.999, 37), [1e-30, 1e-12, np.nextafter(0.5, 0), 0.5, 1 - 1e-9, 1 - 2**-53]])


def share_of(phase, s):
    """The share within sin^2(angle/2) = s, as printed by Fournier & Jonasz 1999, with 60 digits."""
    nu, k = (3 - mp.mpf(phase.junge_slope)) / 2, 4 / (3 * (mp.mpf(phase.refractive_index) - 1) ** 2)
    delta, last = k * s, (k**-nu - 1) / (k - 1)
    first = ((1 - delta ** (nu + 1)) - (1 - delta**nu) * s) / ((1 - delta) * delta**nu)
    return first + last / 2 * (1 - 2 * s) * s * (1 - s)


@pytest.mark.parametrize("phase", [(1.1, 3.5835), (1.02, 3.05), (1.05, 3.2), (1.18, 4.6), (1.33, 4.9)])
def test_fournier_forand(phase):
    """At 1.02 and 3.05 half of the light turns by less than 10^-9: the share beyond an angle is that far from its pole, too."""
    phase = FournierForand(*phase)
    at = fournier_forand.polar(phase, XI)
    with mp.workdps(60):
        for xi, versine, coversine in zip(XI.tolist(), at.versine.tolist(), at.coversine.tolist(), strict=True):
            s = mp.mpf(versine) / 2 if versine < coversine else 1 - mp.mpf(coversine) / 2
            within = share_of(phase, s)
            wanted, found = (1 - mp.mpf(xi), within) if xi >= 0.5 else (mp.mpf(xi), 1 - within)
            if versine < 2.1 * np.exp(-fournier_forand.FARTHEST):  # the smallest angle that is told
                assert found > wanted
                continue
            digits = 2e-15 + 4 * np.finfo(float).eps * abs(np.log(min(float(s), 1 - float(s)) + 1e-300))
            assert abs(found - wanted) <= digits * wanted, (xi, float(found))


@pytest.mark.parametrize("m", [12, 40, 700])
def test_pieces_are_the_sum_of_cosines(m):
    a = np.random.default_rng(3).standard_normal(m)
    theta = np.concatenate([np.linspace(0, np.pi, 1001), [1e-300, np.nextafter(np.pi, 0)]])
    direct = np.cos(theta[:, None] * np.arange(m)) @ a
    f = cosine_series.CosinePieces.of(a)
    assert np.max(np.abs(f(theta) - direct)) < 4e-15 * np.sum(np.abs(a) * (1 + np.arange(m) / 4))


def test_directions_of_a_long_series():
    """A peak of width 1/300 on a floor: the share beyond each angle is its uniform."""
    angles = np.pi * (np.arange(1500) + 0.5) / 1500
    series = cosine_series.CosineSeries(1 + 1e4 * np.exp((np.cos(angles) - 1) * 9e4 / 2))
    at = series.polar(XI)
    theta = 2 * np.arctan2(np.sqrt(at.versine), np.sqrt(at.coversine))
    upto = chebyshev.chebint(2 * np.pi * series.coefficients, lbnd=-1)
    share, value = (np.cos(theta[:, None] * np.arange(len(a))) @ a for a in (upto, series.coefficients))
    assert np.max(np.abs(share - XI)) < 2e-14
    assert np.max(np.abs(at.pdf - value)) < 1e-13 * np.max(at.pdf)
