"""A first guess at the cause (a hole, a wrong integral, an atom, one place) gives way to a hypothesis that explains the samples."""

import numpy as np
import pytest

from fogproof import (
    Box,
    HalfLine,
    Interval,
    Product,
    RealLine,
    UnitHemisphere,
    UnitSphere,
    check_sampler,
)

N = 40_000


def direction(mu, phi):
    s = np.sqrt(np.maximum(1 - mu * mu, 0))
    return np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1)


def cosine_lobe(u):
    return direction(np.sqrt(1 - u[:, 0]), 2 * np.pi * u[:, 1])


def cosine_pdf(w):
    return np.maximum(w[:, 2], 0) / np.pi


ALPHA = 0.4
WO = np.array([np.sin(0.6), 0.0, np.cos(0.6)])


def ggx(mu):
    return ALPHA**2 / (np.pi * (mu * mu * (ALPHA**2 - 1) + 1) ** 2)


def half_vector(u):
    return direction(1 / np.sqrt(1 + ALPHA**2 * u[:, 0] / (1 - u[:, 0])), 2 * np.pi * u[:, 1])


def reflected(u):
    h = half_vector(u)
    return 2 * (h @ WO)[:, None] * h - WO


def half_vector_pdf(w):
    h = w + WO
    mu = np.abs(h[:, 2]) / np.linalg.norm(h, axis=1)
    return ggx(mu) * mu  # over 4 h . wo, it should be


def exponential(u):
    return -np.log1p(-u[:, 0])


def exponential_pdf(t):
    return np.exp(-t)


def slopes(rng, n):
    return rng.normal(0, 1, (n, 2)) * [0.1, 0.3]


def slopes_pdf(s):
    return np.exp(-0.5 * ((s[:, 0] / 0.3) ** 2 + (s[:, 1] / 0.1) ** 2)) / (2 * np.pi * 0.03)


def whole_numbers(x):
    """Poisson's law where x is one, 0 elsewhere: no density."""
    from scipy.stats import poisson

    return poisson(3).pmf(x)


CASES = {  # sampler, pdf, domain, dimensions, atoms; the cause and a word of what explains it
    "a lobe that points down": (
        (lambda u: -cosine_lobe(u), cosine_pdf, UnitSphere(), 2, None),
        ("sign convention", "opposite direction"),
    ),
    "y up": (
        (lambda u: cosine_lobe(u)[:, [0, 2, 1]], cosine_pdf, UnitSphere(), 2, None),
        ("swapped axes", "(x, z, y)"),
    ),
    "centimetres": (
        (lambda u: 100 * exponential(u), exponential_pdf, HalfLine(0), 1, None),
        ("wrong scale", "by 99.9"),
    ),
    "half vectors without their cosine": (
        (half_vector, lambda h: ggx(h[:, 2]), UnitHemisphere(), 2, None),
        ("wrong power", "of the cosine"),
    ),
    "half vectors without their Jacobian": (
        (reflected, half_vector_pdf, UnitSphere(), 2, None),
        ("missing Jacobian", "1/(4 h . wo)"),
    ),
    "projected solid angle": (
        (cosine_lobe, lambda w: np.full(len(w), 1 / np.pi), UnitHemisphere(), 2, None),
        ("wrong measure", "power of the cosine"),
    ),
    "clamped at a wall": (
        (lambda u: np.minimum(exponential(u), 1), exponential_pdf, Interval(0, 1), 1, None),
        ("atom", "such as 1.0, with the probability 0.3679"),
    ),
    "whole numbers": (
        (lambda rng, n: rng.poisson(3, n) * 1.0, whole_numbers, RealLine(), None, None),
        ("atom", "few points"),
    ),
    "the atom alone": (
        (lambda u: np.minimum(exponential(u), 1), exponential_pdf, Interval(0, 1), 1, {1.0: np.exp(-1) + 0.1}),
        ("wrong probability of an atom", "0.467879"),
    ),
    "the rate, and so the atom": (
        (lambda u: np.minimum(exponential(u) / 2, 1), exponential_pdf, Interval(0, 1), 1, {1.0: np.exp(-1)}),
        ("wrong scale", "times as large"),
    ),
    "anisotropic slopes swapped": (
        (slopes, slopes_pdf, Product(RealLine(), RealLine()), None, None),
        ("swapped axes", "order 1, 0"),
    ),
    "a factor in space": (
        (lambda u: u, lambda x: np.full(len(x), 0.5), Box((0, 0, 0), (1, 1, 1)), 3, None),
        ("normalisation", "that is 1/2"),
    ),
    "a hole claimed": (
        (lambda u: u[:, 0], lambda x: (np.abs(x - 0.5) > 1e-3) / 0.998, Interval(0, 1), 1, None),
        ("claimed hole", ""),
    ),
    "one seed for all": (
        (
            lambda rng, n: np.random.default_rng(1).random(n),
            lambda x: np.ones(len(x)),
            Interval(0, 1),
            None,
            None,
        ),
        ("ignores its generator", ""),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_cause_is(name):
    (sample, pdf, domain, dimensions, atoms), (cause, words) = CASES[name]
    verdict = check_sampler(sample, pdf, domain, dimensions=dimensions, atoms=atoms, samples=N)
    assert verdict.outcome == "rejected"
    assert verdict.cause == cause, str(verdict)
    if words == "by 99.9":  # within some of its standard errors
        value, error = (float(verdict.diagnosis.split()[i]) for i in (7, 9))
        assert abs(value - 100) < 6 * error
    else:
        assert words in verdict.diagnosis, verdict.diagnosis


def test_a_pole_where_rounding_gathers_samples_is_no_other_law():
    from scipy.stats import beta

    verdict = check_sampler(
        lambda rng, n: rng.beta(0.1, 0.1, n),
        lambda x: 0.9 * beta(0.1, 0.1).pdf(x),
        Interval(0, 1),
        dimensions=None,
        samples=N,
    )
    assert verdict.cause == "normalisation", str(verdict)
    assert "constant factor 0.9" in verdict.diagnosis or "constant factor 0.89" in verdict.diagnosis


def test_a_crowded_place_is_no_skipped_band():
    """Half of the samples aim at a light that the pdf does not know of: too few elsewhere, and no band explains it."""

    def sample(u):
        towards = direction(1 - 0.02 * u[:, 0], 2 * np.pi * u[:, 1])[:, [2, 0, 1]]
        return np.where(u[:, 2:] < 0.7, towards, direction(1 - 2 * u[:, 0], 2 * np.pi * u[:, 1]))

    verdict = check_sampler(sample, lambda w: np.full(len(w), 0.25 / np.pi), UnitSphere(), dimensions=3, samples=N)
    assert verdict.outcome == "rejected"
    assert verdict.cause not in ("skipped band", "missing tail", "missing patch"), str(verdict)
