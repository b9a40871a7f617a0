"""What people do wrong with numbers is named, small as it may be; what is not pinned is not told."""

import numpy as np
import pytest
from laws_by_hand import TURN, bell, decay, even, exponential, hold, normal
from scipy.special import erf
from scipy.stats import beta, weibull_min

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
