"""Poles at a 0 inside the domain: numbers lie closer there than points of a law whose coordinates do not end at it."""

import numpy as np
import pytest
from scipy import stats

from fogproof import Box, Interval, RealLine, Rectangle, check_sampler
from fogproof.domains.line import centre

N = 60_000


def pole(u, power=10):
    """Points of the density |x|^(1 / power - 1) / (2 power) on [-1, 1]."""
    return np.where(u[:, 0] < 0.5, -1, 1) * u[:, 1] ** power


def pole_pdf(x):
    return 0.05 * np.abs(x) ** -0.9


def two_sided_gamma(rng, n):
    return rng.gamma(0.1, 1, n) * np.where(rng.random(n) < 0.5, -1, 1)


def gamma_and_normal(rng, n):
    return np.where(rng.random(n) < 0.1, rng.gamma(0.1, 1, n), rng.normal(5, 1, n))


def beside_a_pole(u):
    return np.column_stack([pole(u), u[:, 2]])


def plane_pdf(x):
    return pole_pdf(x[:, 0])


SQUARE = Rectangle((-1, 0), (1, 1))
ON_LINES = {
    "interval": (pole, pole_pdf, Interval(-1, 1), 2),
    "one side": (lambda rng, n: rng.gamma(0.1, 1, n), stats.gamma(0.1).pdf, RealLine(), None),
    "two sides": (two_sided_gamma, lambda x: 0.5 * stats.gamma(0.1).pdf(np.abs(x)), RealLine(), None),
}
KNOWN_BY_LABELS = {
    "of little weight": (
        gamma_and_normal,
        lambda x: 0.1 * stats.gamma(0.1).pdf(x) + 0.9 * stats.norm.pdf(x, 5),
        RealLine(),
        None,
    ),
    "in a box": (lambda u: pole(u)[:, None], plane_pdf, Box((-1,), (1,)), 2),
    "in a plane": (beside_a_pole, plane_pdf, SQUARE, 3),
}


def judged(sample, pdf, domain, dimensions, samples=N):
    with np.errstate(divide="ignore"):
        return check_sampler(sample, pdf, domain, dimensions=dimensions, samples=samples)


@pytest.mark.parametrize("name", ON_LINES)
def test_a_pole_at_0_is_integrated(name):
    verdict = judged(*ON_LINES[name])
    assert verdict.outcome == "not rejected", str(verdict)
    assert any(f.message.startswith("the pdf integrates to") for f in verdict.findings), str(verdict)


@pytest.mark.parametrize("name", KNOWN_BY_LABELS)
def test_points_that_the_known_law_cannot_have_are_no_evidence(name):
    verdict = judged(*KNOWN_BY_LABELS[name], 2 * N)
    assert verdict.outcome == "not rejected", str(verdict)
    assert any("labels" in f.message for f in verdict.findings), str(verdict)


@pytest.mark.parametrize("name", ON_LINES)
def test_a_pole_one_hundredth_too_high_is_seen(name):
    sample, pdf, domain, dimensions = ON_LINES[name]
    verdict = judged(sample, lambda x: pdf(x) * np.where(np.abs(x) < 1e-20, 1.01, 1.0), domain, dimensions)
    assert verdict.cause == "normalisation", str(verdict)


def test_what_the_known_law_cannot_have_is_missed_elsewhere():
    def without(u):
        x = beside_a_pole(u)
        lost = np.abs(x[:, 0]) < 1e-14
        x[lost, 0] = 2 * u[lost, 2] - 1
        return x

    verdict = judged(without, plane_pdf, SQUARE, 3, 4 * N)
    assert verdict.outcome == "rejected", str(verdict)


def test_another_power_is_seen_by_labels():
    verdict = judged(lambda u: np.column_stack([pole(u, 8), u[:, 2]]), plane_pdf, SQUARE, 3)
    assert verdict.outcome == "rejected", str(verdict)


def test_points_of_a_law_are_as_far_apart_as_its_coordinates_have_it():
    law = Interval(-1, 1).law(np.empty(0))
    below, above = law.neighbours(np.array([1e-30, 0.75]))
    assert np.all((above - below > 1e-16) & (above - below < 2e-15))
    below, above = Interval(0, 1).law(np.empty(0)).neighbours(np.array([1e-30]))
    assert 0 < above - below < 1e-44


def test_the_centre_is_0_where_numbers_crowd_there_alone():
    u = (np.arange(4096) + 0.5) / 4096
    assert centre(stats.gamma(0.1).ppf(u)) == 0.0
    assert centre(stats.norm(3).ppf(u)) == pytest.approx(3.0)
    assert centre(np.concatenate([stats.norm(3).ppf(u), np.zeros(400)])) > 2.0, "a clamped sample is no pole"
