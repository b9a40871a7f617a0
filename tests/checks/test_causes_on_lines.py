"""What people do wrong with numbers is named, small as it may be; what is not pinned is not told."""

import re

import numpy as np
import pytest
from laws_by_hand import TURN, bell, decay, even, exponential, hold, normal
from scipy.special import erf
from scipy.stats import beta, t, weibull_min

from fogproof import HalfLine, Interval, RealLine, check_sampler

N = 30_000
MORE = 120_000  # pin a factor


CASES = {  # sampler, pdf, domain, dimensions; the cause and words of what explains it
    "shifted a little": ((lambda u: normal(u) + 0.07, bell, RealLine(), 1), "shifted", "by 0.0"),
    "a variance for the deviation": (
        (lambda u: 9 * normal(u), lambda x: bell(x / 3) / 3, RealLine(), 1),
        "wrong scale",
        "variance stood for",
    ),
    "wider about 5": (
        (lambda u: 5 + 1.1 * normal(u), lambda x: bell(x - 5), RealLine(), 1),
        "wrong scale",
        "about 5",
    ),
    "log2 for ln": ((lambda u: exponential(u) / np.log(2), decay, HalfLine(0), 1), "wrong scale", "binary logarithm"),
    "a sign": ((lambda u: np.abs(normal(u)), bell, RealLine(), 1), "lost sign", "the sign of x is lost"),
    "a sign of a law that is not even": (
        (lambda u: np.abs(normal(u) + 0.5), lambda x: bell(x - 0.5), RealLine(), 1),
        "lost sign",
        "the sign of x is lost",
    ),
    "a tail that has no end": ((lambda u: normal(0.9 * u), bell, RealLine(), 1), "missing tail", "lies in x > 1.28"),
    "the tail at the other end": (
        (lambda u: -normal(0.9 * u), bell, RealLine(), 1),
        "missing tail",
        "lies in x < -1.28",
    ),
    "a tail of a half line": (
        (lambda u: exponential(0.9 * u), decay, HalfLine(0), 1),
        "missing tail",
        "lies in x > 2.30",
    ),
    "degrees": ((lambda u: np.degrees(exponential(u)), decay, HalfLine(0), 1), "wrong scale", "degrees"),
    "another shape parameter": (
        (lambda u: weibull_min(2).ppf(u[:, 0]), weibull_min(1.5).pdf, HalfLine(0), 1),
        "wrong power",
        "of x raised to the power 0.7",
    ),
    "r for r^2": ((lambda u: u[:, 0], lambda x: 2 * x, Interval(0, 1), 1), "missing Jacobian", "square root"),
    "an angle for its cosine": (
        (lambda u: np.pi * u[:, 0], lambda x: 0.5 * np.sin(x), Interval(0, np.pi), 1),
        "missing Jacobian",
        "a sine is missing",
    ),
    "mirrored, where rounding gathers samples": (
        (lambda u: 1 - beta(0.2, 3).ppf(u[:, 0]), beta(0.2, 3).pdf, Interval(0, 1), 1),
        "sign convention",
        "turned round",
    ),
    "an edge that hides ripples": (
        (
            lambda u: np.where(u[:, 0] == 0, np.inf, u[:, 0] + 0.05 * np.sin(6 * np.pi * u[:, 0]) / TURN),
            even(1),
            Interval(0, 1),
            1,
        ),
        "shape",
        "",
    ),
}


KNOTS = np.linspace(0, 1, 9)
HEIGHTS = np.array([1.0, 3, 2, 5, 4, 2, 6, 1, 2])
HEIGHTS = HEIGHTS / np.trapezoid(HEIGHTS, KNOTS)
SHARES = np.concatenate([[0], np.cumsum(0.5 * (HEIGHTS[1:] + HEIGHTS[:-1]) / 8)])


def tabulated(u, segment):
    """Samples of a density that is linear between knots, and even in one segment, as of an inverse that forgets its slope."""
    v = u[:, 0]
    i = np.clip(np.searchsorted(SHARES, v, side="right") - 1, 0, 7)
    left = (v - SHARES[i]) / (SHARES[i + 1] - SHARES[i])
    a, b = HEIGHTS[i], HEIGHTS[i + 1]
    place = (np.sqrt(a * a + (b * b - a * a) * left) - a) / (b - a)
    return (i + np.where(i == segment, left, place)) / 8


def layered(u):
    """Exponential samples, of which a layer of height 0.15 from 0 to 0.8 lies too far to the right."""
    x = exponential(u)
    return np.where((u[:, 1] * np.exp(-x) < 0.15) & (x < 0.8), x + 0.2, x)


def moved(u):
    x = exponential(u)
    return np.where((x > 0.5) & (x < 1), x + 0.2, x)


STRETCHES = {
    "a segment of a table": (
        lambda u: tabulated(u, 5),
        lambda x: np.interp(x, KNOTS, HEIGHTS),
        Interval(0, 1),
        (0.625, 0.75),
    ),
    "a layer": (layered, decay, HalfLine(0), (0.0, 1.0)),
    "a piece": (moved, decay, HalfLine(0), (0.5, 1.2)),
}
ELSEWHERE = {  # is the law wrong too, or not as many samples are there as should
    "more in a stretch": (
        lambda u: np.where(u[:, 1] < 0.03, 0.4 + 0.05 * u[:, 0], u[:, 0]),
        even(1),
        Interval(0, 1),
    ),
    "fewer in a stretch": (
        lambda u: np.where((u[:, 0] > 0.4) & (u[:, 0] < 0.5), u[:, 1], u[:, 0]),
        even(1),
        Interval(0, 1),
    ),
    "ripples": (lambda u: u[:, 0] + 0.05 * np.sin(6 * np.pi * u[:, 0]) / TURN, even(1), Interval(0, 1)),
    "heavy tails": (lambda u: t(5).ppf(np.clip(u[:, 0], 1e-12, 1 - 1e-12)), bell, RealLine()),
    "another shape parameter": (lambda u: weibull_min(1.9).ppf(u[:, 0]), weibull_min(1.8).pdf, HalfLine(0)),
}


@pytest.mark.parametrize("name", STRETCHES)
def test_a_stretch_that_is_displaced_is_told(name):
    sample, pdf, domain, (low, high) = STRETCHES[name]
    verdict = check_sampler(sample, pdf, domain, dimensions=2, samples=MORE)
    assert (verdict.outcome, verdict.cause) == ("rejected", "displaced stretch"), str(verdict)
    ends = [float(end) for end in re.search(r"in ([-0-9.e]+) < x < ([-0-9.e]+):", verdict.diagnosis).groups()]
    assert np.allclose(ends, (low, high), atol=0.1), verdict.diagnosis


@pytest.mark.parametrize("samples", [N, MORE])
@pytest.mark.parametrize("name", ELSEWHERE)
def test_no_stretch_is_displaced(name, samples):
    verdict = check_sampler(*ELSEWHERE[name], dimensions=2, samples=samples)
    assert verdict.outcome == "rejected"
    assert "layer" not in verdict.diagnosis, str(verdict)


@pytest.mark.parametrize("name", CASES)
def test_the_cause_is(name):
    hold(CASES[name], MORE if CASES[name][1] == "wrong scale" else N)


@pytest.mark.parametrize(("sample", "pdf", "domain", "cdf"), [
    (exponential, decay, HalfLine(0), decay),
    (normal, bell, RealLine(), lambda x: 0.5 - 0.5 * erf(x / np.sqrt(2))),
    (lambda u: np.sqrt(u[:, 0]), lambda x: 2 * x, Interval(0, 1), lambda x: 1 - x * x),
])  # fmt: skip
def test_a_complementary_cdf_is_named(sample, pdf, domain, cdf):
    verdict = check_sampler(sample, pdf, domain, dimensions=1, samples=4000, cdf=cdf)
    assert (verdict.outcome, verdict.cause) == ("rejected", "complementary cdf"), str(verdict)


def test_a_scale_off_by_a_hundredth_is_fitted():
    verdict = check_sampler(lambda u: 1.025 * exponential(u), decay, HalfLine(0), dimensions=1, samples=300_000)
    assert verdict.cause == "wrong scale", str(verdict)
    value, error = (float(verdict.diagnosis.split()[i]) for i in (8, 10))
    assert abs(1 / value - 1.025) < 6 * error
    assert error < 0.005
