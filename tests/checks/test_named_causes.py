"""What people do wrong with lines, disks, spheres, balls, products is named, small as it may be; what is not pinned is not told."""

import numpy as np
import pytest
from scipy.special import erf, ndtri
from scipy.stats import beta, weibull_min

from fogproof import (
    Ball,
    HalfLine,
    Interval,
    Product,
    RealLine,
    UnitDisk,
    UnitHemisphere,
    UnitSphere,
    UnitSquare,
    check_sampler,
)

N = 60_000
MORE = 200_000  # pin a factor
TURN = 2 * np.pi


def exponential(u):
    return -np.log1p(-u[:, 0])


def decay(x):
    return np.exp(-x)


def normal(u):
    return ndtri(np.clip(u[:, 0], 1e-16, 1 - 1e-16))


def bell(x):
    return np.exp(-0.5 * x * x) / np.sqrt(TURN)


def about(mu, phi):
    s = np.sqrt(np.maximum(1 - mu * mu, 0))
    return np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1)


def even(measure):
    return lambda x: np.full(len(x), 1 / measure)


def fisher(kappa):
    return (
        lambda u: about(1 + np.log1p(u[:, 0] * np.expm1(-2 * kappa)) / kappa, TURN * u[:, 1]),
        lambda x: kappa / (TURN * -np.expm1(-2 * kappa)) * np.exp(kappa * (x[:, 2] - 1)),
    )


def flight(scale, mu):
    return lambda u: np.column_stack([scale * exponential(u), about(mu(u[:, 1]), TURN * u[:, 2])])


def flight_pdf(x):
    """Exponential distance, direction with density (1 + mu) / (4 pi)."""
    return np.exp(-x[:, 0]) * (1 + x[:, 3]) / (2 * TURN)


def forward(u):
    return 2 * np.sqrt(u) - 1


CASES = {  # sampler, pdf, domain, dimensions; the cause and words of what explains it
    "shifted a little": ((lambda u: normal(u) + 0.05, bell, RealLine(), 1), "shifted", "by 0.0"),
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
    "a square without its root": (
        (lambda u: u, lambda x: 2 * x[:, 0], UnitSquare(), 2),
        "missing Jacobian",
        "square root",
    ),
    "half a turn of a disk": (
        (lambda u: np.sqrt(u[:, :1]) * about(0 * u[:, 0], np.pi * u[:, 1])[:, :2], even(np.pi), UnitDisk(), 2),
        "skipped band",
        "azimuth over pi",
    ),
    "half a turn of a hemisphere": (
        (lambda u: about(np.sqrt(u[:, 0]), np.pi * u[:, 1]), lambda x: x[:, 2] / np.pi, UnitHemisphere(), 2),
        "skipped band",
        "azimuth over pi",
    ),
    "a lobe's own parameter": ((fisher(9)[0], fisher(7)[1], UnitSphere(), 2), "another parameter", "the pdf's is 7"),
    "a ball's sine": (
        (
            lambda u: np.cbrt(u[:, :1]) * about(np.cos(np.pi * u[:, 1]), TURN * u[:, 2]),
            even(2 / 3 * TURN),
            Ball(),
            3,
        ),
        "missing Jacobian",
        "sine",
    ),
    "a ball's radius, off the origin": (
        (
            lambda u: [1, 2, 3] + u[:, :1] * about(2 * u[:, 1] - 1, TURN * u[:, 2]),
            even(2 / 3 * TURN),
            Ball(1, (1, 2, 3)),
            3,
        ),
        "missing Jacobian",
        "r^2 is missing",
    ),
    "the scale of one part": (
        (flight(1.4, forward), flight_pdf, Product(HalfLine(0), UnitSphere()), 3),
        "wrong scale",
        "in the column 0",
    ),
    "the sign of one part": (
        (flight(1, lambda u: -forward(u)), flight_pdf, Product(HalfLine(0), UnitSphere()), 3),
        "sign convention",
        "in the columns 1 to 3",
    ),
    "a correlation's sign": (
        (
            lambda u: np.column_stack([-normal(u), 0.6 * normal(u) + 0.8 * normal(u[:, 1:])]),
            lambda x: bell(x[:, 0]) * bell((x[:, 1] - 0.6 * x[:, 0]) / 0.8) / 0.8,
            Product(RealLine(), RealLine()),
            2,
        ),
        "sign convention",
        "",
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
    (sample, pdf, domain, dimensions), cause, words = CASES[name]
    verdict = check_sampler(sample, pdf, domain, dimensions=dimensions, samples=MORE if cause == "wrong scale" else N)
    assert (verdict.outcome, verdict.cause) == ("rejected", cause), str(verdict)
    assert words in verdict.diagnosis, verdict.diagnosis


@pytest.mark.parametrize(("sample", "pdf", "domain", "cdf"), [
    (exponential, decay, HalfLine(0), decay),
    (normal, bell, RealLine(), lambda x: 0.5 - 0.5 * erf(x / np.sqrt(2))),
    (lambda u: np.sqrt(u[:, 0]), lambda x: 2 * x, Interval(0, 1), lambda x: 1 - x * x),
])  # fmt: skip
def test_a_complementary_cdf_is_named(sample, pdf, domain, cdf):
    verdict = check_sampler(sample, pdf, domain, dimensions=1, samples=N, cdf=cdf)
    assert (verdict.outcome, verdict.cause) == ("rejected", "complementary cdf"), str(verdict)


def test_a_scale_off_by_a_hundredth_is_fitted():
    verdict = check_sampler(lambda u: 1.025 * exponential(u), decay, HalfLine(0), dimensions=1, samples=300_000)
    assert verdict.cause == "wrong scale", str(verdict)
    value, error = (float(verdict.diagnosis.split()[i]) for i in (8, 10))
    assert abs(1 / value - 1.025) < 6 * error
    assert error < 0.005


def test_a_cone_hardly_too_wide_has_no_parameter_that_is_not_pinned():
    def sample(u):
        return about(1 - u[:, 0] * (1 - np.cos(0.404)), TURN * u[:, 1])

    def pdf(x):
        return (x[:, 2] >= np.cos(0.4) - 1e-12) / (TURN * (1 - np.cos(0.4)))

    verdict = check_sampler(sample, pdf, UnitSphere(), dimensions=2, samples=N)
    assert verdict.outcome == "rejected"
    words, fitted, _ = verdict.diagnosis.partition(" +-")
    told = [float(words.split()[-1])] if fitted else []
    assert all(1 < value < 1.06 for value in told), verdict.diagnosis
