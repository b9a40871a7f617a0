"""Invariant: Fournier & Forand's phase function is the printed one, to its stated errors, straight ahead as well."""

import mpmath as mp
import numpy as np
import pytest

from fogproof.analytic import (
    airlight_integral,
    airlight_second_moment,
    phase_cdf,
    phase_legendre_moments,
    phase_mean_cosine,
    phase_pdf,
    phase_quantile,
    single_scattering,
)
from fogproof.analytic.phase.fournier_forand import density
from fogproof.errors import InvalidValueError
from fogproof.estimators.phase import fournier_forand as drawn
from fogproof.oracle import answer
from fogproof.scene import Environment, FournierForand, Medium, Ray
from fogproof.scene.shapes import HalfSpace

PHASES = [FournierForand(1.1, 3.5835), FournierForand(1.02, 3.2), FournierForand(1.33, 4.9), FournierForand(2.5, 4.0)]


def _constants(phase):
    n, slope = mp.mpf(phase.refractive_index), mp.mpf(phase.junge_slope)
    return (3 - slope) / 2, 4 / (3 * (n - 1) ** 2)


def printed(phase, s):
    """Fournier & Jonasz 1999, eq. 3, at sin^2(angle/2) = s, in 100 digits."""
    nu, k = _constants(phase)
    d, mu = k * s, 1 - 2 * s
    first = nu * (1 - d) - (1 - d**nu) + (d * (1 - d**nu) - nu * (1 - d)) / s
    last = (1 - k**nu) / (16 * mp.pi * (k - 1) * k**nu) * (3 * mu * mu - 1)
    return first / (4 * mp.pi * (1 - d) ** 2 * d**nu) + last


def printed_share(phase, s):
    """The same, eq. 7: the share of light that scatters less."""
    nu, k = _constants(phase)
    d = k * s
    first = (1 - d ** (nu + 1) - (1 - d**nu) * s) / ((1 - d) * d**nu)
    return first + (1 - k**nu) / ((k - 1) * k**nu) / 2 * (1 - 2 * s) * s * (1 - s)


def _places(phase):
    k = 4 / (3 * (phase.refractive_index - 1) ** 2)
    near = np.array([1 - 1e-9, 1 + 1e-6, 0.96, 1.04, 0.64, 1.36, 0.36, 0.37, 2.7, 2.72]) / k
    x = np.concatenate([np.geomspace(1e-40, 1e-3, 40), np.linspace(0.01, 1, 40), near])
    return x[x <= 1]


@pytest.mark.parametrize("phase", PHASES, ids=repr)
def test_the_density_is_the_printed_one(phase):
    x = _places(phase)
    y = 1 - x
    value, error = density(phase, x, y)
    own = drawn.density(phase, 2 * x, 2 * y)
    with mp.workdps(100):
        for i, s in enumerate(x):
            right = printed(phase, mp.mpf(s))
            slack = 2e-16 * right  # y is rounded
            assert abs(mp.mpf(value[i]) - right) <= error[i] + slack
            assert abs(mp.mpf(own[i]) - right) <= 2e-12 * right
    assert np.all(error <= 2e-13 * value)


@pytest.mark.parametrize("phase", PHASES, ids=repr)
def test_it_is_normalised_and_the_distribution_is_its_integral(phase):
    with mp.workdps(100):
        power = 2 / (mp.mpf(phase.junge_slope) - 3)  # s = y^power takes the singularity away
        for end in (0.3, 1.0):
            total = mp.quad(
                lambda y: 4 * mp.pi * printed(phase, y**power) * power * y ** (power - 1),
                [0, 0.01, 0.1, 0.5, mp.mpf(end) ** (1 / power)],
            )
            share = printed_share(phase, mp.mpf(end)) if end < 1 else 1
            assert abs(total - share) < mp.mpf(10) ** -30
    mu = np.concatenate([np.linspace(-1, 0.999, 50), 1 - np.geomspace(1e-15, 1e-4, 30)])
    found = phase_cdf(phase, mu)
    with mp.workdps(100):
        for i, cosine in enumerate(mu):
            assert abs(mp.mpf(found.value[i]) - (1 - printed_share(phase, (1 - mp.mpf(cosine)) / 2))) <= found.error[i]
    assert np.all(found.error < 1e-13)
    assert phase_cdf(phase, 1.0).value == 1


def test_straight_ahead_it_is_infinite():
    assert phase_pdf(PHASES[0], 1.0).value == np.inf
    ends = phase_quantile(PHASES[0], [0.0, 1.0])
    assert np.all(np.abs(ends.value - [-1, 1]) <= ends.error)
    for rigorous in (False, True):
        found = airlight_integral(1.0, 0.0, -3.0, -1.0, PHASES[0], rigorous=rigorous)
        assert found.value == np.inf
        assert found.error == 0


@pytest.mark.parametrize("phase", PHASES, ids=repr)
def test_airlight_lies_in_the_proven_interval(phase):
    rng = np.random.default_rng(7)
    sigma, h = 10 ** rng.uniform(-2, 1, 6), 10 ** rng.uniform(-4, 1, 6)
    a = rng.uniform(-5, 5, 6)
    b = a + 10 ** rng.uniform(-2, 1.5, 6)
    b[0] = np.inf
    found, proven = (airlight_integral(sigma, h, a, b, phase, rigorous=rigorous) for rigorous in (False, True))
    assert np.all(np.abs(found.value - proven.value) <= found.error + proven.error)
    assert np.all(found.error <= 1e-12 * found.value)


def test_moments_by_the_distribution():
    """chi_1 and chi_2 by parts: no density in them."""
    phase = PHASES[0]
    with mp.workdps(40):

        def below(x):  # the integral of F (1 or mu) over mu, with mu = 1 - 2 x
            return 1 - printed_share(phase, x)

        first = 1 - mp.quad(lambda x: 2 * below(x), [0, 1e-6, 1e-3, 0.1, 1])
        second = 1 - mp.quad(lambda x: 6 * (1 - 2 * x) * below(x), [0, 1e-6, 1e-3, 0.1, 1])
    found = phase_legendre_moments(phase, 2)
    assert abs(found.value[1] - first) <= found.error[1]
    assert abs(found.value[2] - second) <= found.error[2]
    assert abs(phase_mean_cosine(phase).value - first) <= phase_mean_cosine(phase).error
    assert found.error.max() < 1e-12


def test_backscatter():
    for n, share in ((1.1, 0.0183), (1.05, 0.0025), (1.5, 0.3), (1 + np.sqrt(2 / 3), 0.2), (2.5, 0.45)):
        phase = FournierForand.from_backscatter(n, share)
        assert abs(phase_cdf(phase, 0.0).value - share) < 1e-14
    with pytest.raises(InvalidValueError, match=r"backscatter must lie in the open interval \(0, 1/2\), got 0.5"):
        FournierForand.from_backscatter(1.1, 0.5)


@pytest.mark.parametrize("phase", PHASES, ids=repr)
def test_the_sampler_inverts_the_distribution(phase):
    xi = np.concatenate([np.random.default_rng(3).random(2000), [0.0, 1e-300, 0.5, 1 - 2**-53]])
    at = drawn.polar(phase, xi)
    assert np.all((at.versine > 0) & (at.versine <= 2) & (at.coversine >= 0) & np.isfinite(at.pdf))
    with mp.workdps(60):
        for i in (*range(0, 2000, 40), *range(2000, 2004)):
            share = printed_share(phase, mp.mpf(at.versine[i]) / 2)
            assert abs(share - (1 - mp.mpf(xi[i]))) < 1e-13


def test_other_answers():
    """Second moments, an environment, a request in JSON."""
    phase = PHASES[0]
    assert airlight_second_moment(1.0, 0.5, -2.0, 3.0, phase).error < 1e-12
    medium, ray = Medium(0.5, 0.5, phase), Ray((0, 0, -1.0), (0, 0.6, 0.8), 1.0)
    lit = single_scattering(medium, ray, Environment(1.0), shape=HalfSpace((0, 0, 0), (0, 0, 1)))
    assert 0 < lit.error < 1e-8 * lit.value
    request = {"quantity": "phase_pdf", "mu": 0.5,
               "phase": {"kind": "fournier-forand", "refractive_index": 1.1, "junge_slope": 3.5835}}  # fmt: skip
    assert answer(request)["value"] == float(phase_pdf(phase, 0.5).value)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((1.0, 3.5), "refractive_index must be finite and > 1, got 1.0"),
        ((1.1, 3.0), r"junge_slope must lie in the open interval \(3, 5\), got 3.0; at 3 all light goes straight on"),
        ((1.1, 5.0), "junge_slope"),
        ((np.inf, 4.0), "refractive_index"),
        (("water", 4.0), "refractive_index must be a number"),
    ],
)
def test_what_is_none_is_refused(arguments, message):
    with pytest.raises(InvalidValueError, match=message):
        FournierForand(*arguments)
