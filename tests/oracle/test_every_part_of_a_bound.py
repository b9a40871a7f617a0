"""Each part of an error bound is there for some input: here is one where the truth lies outside without it.

Dot products that cancel are made exactly: two large terms, and between them a third that takes up what is left of them.
"""

from __future__ import annotations

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from media_truth import within

from fogproof.analytic import ambient_fog, free_path, optical_thickness, phase_cdf, phase_pdf
from fogproof.scene import ExponentialMedium, HenyeyGreenstein, Isotropic, LinearMedium, Medium, Mixture, Ray

EPS = np.finfo(float).eps


def cancelling(rng, size, rest):
    """Return vectors (3,), (3,) whose dot product is about `rest`, though two of its terms are about size^2; and the product."""
    left, right = size * (0.5 + rng.random(3)), size * (0.5 + rng.random(3))
    left[2] = -left[0] * right[0] / right[2]
    left[1] = 1.0 + rng.random()
    right[1] = (rest - float(exact_dot(left[::2], right[::2]))) / left[1]
    return left, right, exact_dot(left, right)


def exact_dot(left, right):
    return sum((Fraction(float(a)) * Fraction(float(b)) for a, b in zip(left, right, strict=True)), Fraction())


def exactly(x):
    return mp.mpf(x.numerator) / x.denominator


@pytest.mark.parametrize("seed", range(6))
def test_an_exponent_of_large_terms(seed):
    """Bound without the exponent's error: 5e-15 of a thickness that is off by 1e-12."""
    rate, origin, e = cancelling(np.random.default_rng(seed), 1e10, 0.3)
    medium, ray = ExponentialMedium(1.3, rate, albedo=0.5), Ray(origin, (0, 1, 0), 1.0)
    with mp.workdps(50):
        truth = mp.mpf(1.3) * mp.exp(exactly(e)) * mp.expm1(mp.mpf(rate[1])) / mp.mpf(rate[1])
        reference = optical_thickness(medium, ray)
        within(reference, truth)
        fog = ambient_fog(medium, ray, 2.0, 5.0)
        within(fog, 5 * mp.exp(-truth) + mp.mpf(0.5) * 2 * -mp.expm1(-truth))
    assert reference.error <= 1e-8 * reference.value
    assert fog.error <= 1e-8 * fog.value


def test_some_of_these_need_their_parts():
    """The cases above are hard enough: in most of them what is left of the bound would not do."""
    short = 0
    for seed in range(6):
        rate, origin, e = cancelling(np.random.default_rng(seed), 1e10, 0.3)
        found = optical_thickness(ExponentialMedium(1.3, rate), Ray(origin, (0, 1, 0), 1.0)).value
        with mp.workdps(50):
            truth = mp.mpf(1.3) * mp.exp(exactly(e)) * mp.expm1(mp.mpf(rate[1])) / mp.mpf(rate[1])
        short += abs(found - truth) > 20 * EPS * truth
    assert short >= 3


@pytest.mark.parametrize("seed", range(6))
def test_a_slope_of_large_terms(seed):
    rng = np.random.default_rng(seed)
    direction = np.array([0.48, 0.6, 0.64])
    gradient = 1e20 * (0.5 + rng.random(3))
    gradient[2] = -gradient[0] * direction[0] / direction[2]
    gradient[1] = (0.7 - float(exact_dot(gradient[::2], direction[::2]))) / direction[1]
    slope = exact_dot(gradient, direction)
    medium, length = LinearMedium(2 * float(abs(slope)) + 1.0, gradient), 0.75
    with mp.workdps(50):
        truth = exactly(Fraction(float(medium.sigma_0)) * Fraction(length) + slope * Fraction(length) ** 2 / 2)
        reference = optical_thickness(medium, Ray((0, 0, 0), direction, length))
        within(reference, truth)
    assert reference.error <= 1e-6 * reference.value


def test_the_rounding_of_a_quotient():
    """A free path through a homogeneous medium is one division: off by half a unit in the last place, and by no more than two."""
    medium, tau = Medium(0.1, 0.2), np.random.default_rng(1).random(200) * 3
    found = free_path(medium, Ray((0, 0, 0), (0, 0, 1), np.inf), tau)
    sigma, off = Fraction(0.1) + Fraction(0.2), 0.0
    for t, value, error in zip(tau, found.value, found.error, strict=True):
        miss = abs(Fraction(float(value)) - Fraction(float(t)) / sigma)
        assert miss <= error <= 2 * EPS * value
        off = max(off, float(miss) / value)
    assert off > 0.1 * EPS


@pytest.mark.parametrize("step", range(-4, 5))
def test_whether_a_ray_escapes_is_open_within_rounding(step):
    """The whole thickness of a fading medium is sigma_0/|rate|: at it nobody can say which side of the limit tau lies on."""
    medium, ray = ExponentialMedium(1 / 3, (0, 0, -0.7)), Ray((0, 0, 0), (0, 0, 1), np.inf)
    limit = (1 / 3) / 0.7
    assert free_path(medium, ray, limit + step * np.spacing(limit)).error == np.inf
    decided = free_path(medium, ray, limit * np.array([1 - 1e-9, 1 + 1e-9]))
    assert np.isfinite(decided.error).all()
    assert np.isfinite(decided.value).tolist() == [True, False]


def test_whether_a_path_ends_within_the_ray_is_open_within_rounding():
    medium, lengths = Medium(0.1, 0.2), np.array([0.7, 1.1, 5.3])
    tau = np.array([float((Fraction(0.1) + Fraction(0.2)) * Fraction(s)) for s in lengths])
    rays = Ray(np.zeros((3, 3)), (0, 0, 1), lengths)
    assert (free_path(medium, rays, tau).error == np.inf).all()
    before, after = free_path(medium, rays, 0.999 * tau), free_path(medium, rays, 1.001 * tau)
    assert np.isfinite([before.value, before.error, after.error]).all()
    assert np.isinf(after.value).all()


def test_weights_that_do_not_quite_sum_to_one_are_divided_by_their_sum():
    weights = (0.25, 0.75 + 8e-10)
    mixed = Mixture((Isotropic(), HenyeyGreenstein(0.5)), weights)
    with mp.workdps(40):
        first, second = (mp.mpf(w) / (mp.mpf(weights[0]) + mp.mpf(weights[1])) for w in weights)
        mu, g = mp.mpf(0.375), mp.mpf(0.5)
        lobe = (1 - g * g) / (1 + g * g - 2 * g * mu) ** mp.mpf(1.5) / (4 * mp.pi)
        within(phase_pdf(mixed, 0.375), first / (4 * mp.pi) + second * lobe)
    end = phase_cdf(mixed, 1.0)
    assert abs(end.value - 1) <= end.error <= 1e-14
