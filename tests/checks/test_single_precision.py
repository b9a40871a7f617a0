"""Rounding in single precision is charged where it arises: narrow lobes are judged all the same, and right ones left alone."""

from dataclasses import replace

import numpy as np
import pytest

from fogproof import Interval, UnitSphere, check_sampler, sampler_check
from fogproof.checks.normalisation import pdf_noise
from fogproof.checks.subject import Subject

TENTH = 2 * np.sin(np.radians(0.1) / 2) ** 2
SINGLE = {"dimensions": 2, "precision": "float32", "samples": 300_000}


def versine(x):
    small = (x[:, 0] ** 2 + x[:, 1] ** 2) / (1 + np.abs(x[:, 2]))
    return np.where(x[:, 2] < 0, 2 - small, small)


def around(v, phi):
    sine = np.sqrt(v * (2 - v))
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), 1 - v], axis=-1)


def cone(power):
    def sample(u):
        kind = u.dtype.type
        return around(u[:, 0] ** power * kind(TENTH), kind(2 * np.pi) * u[:, 1])

    return sample


def cone_pdf(x):
    return np.where(versine(x) <= TENTH * (1 + 1e-6), 1 / (2 * np.pi * TENTH), 0)


def lobe(g, turn, textbook):
    def sample(u):
        kind = u.dtype.type
        g_, phi = kind(g), kind(2 * np.pi * turn) * u[:, 1]
        if textbook:
            s = (1 - g_ * g_) / (1 - g_ + 2 * g_ * u[:, 0])
            mu = np.clip((1 + g_ * g_ - s * s) / (2 * g_), -1, 1)
            sine = np.sqrt(1 - mu * mu)
            return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)
        back = 1 - u[:, 0]
        return around(2 * (1 - g_) ** 2 * back * (1 + g_ * u[:, 0]) / (1 - g_ + 2 * g_ * u[:, 0]) ** 2, phi)

    return sample


def lobe_pdf(g):
    return lambda x: (1 - g * g) / (4 * np.pi * ((1 - g) ** 2 + 2 * g * versine(x)) ** 1.5)


def always_single(sample):
    return lambda u: sample(u.astype(np.float32))


def rounded_at_last(sample):
    return lambda u: sample(u.astype(np.float64)).astype(np.float32)


STYLES = {"as its uniforms": lambda f: f, "always single": always_single, "rounded at last": rounded_at_last}
RIGHT = {
    "cone of a tenth of a degree": (cone(1), cone_pdf),
    "g = 0.99": (lobe(0.99, 1, False), lobe_pdf(0.99)),
    "g = 0.99 by the textbook": (lobe(0.99, 1, True), lobe_pdf(0.99)),
    "g = -0.99 by the textbook": (lobe(-0.99, 1, True), lobe_pdf(-0.99)),
    "g = 0.999": (lobe(0.999, 1, False), lobe_pdf(0.999)),
}
WRONG = {
    "cone with the square of a uniform": (cone(2), cone_pdf),
    "1 % of the azimuth missing": (lobe(0.99, 0.99, False), lobe_pdf(0.99)),
    "1 % of the azimuth missing, by the textbook": (lobe(0.99, 0.99, True), lobe_pdf(0.99)),
}


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("name", RIGHT)
def test_right_narrow_lobes_pass(name, style):
    sample, pdf = RIGHT[name]
    verdict = check_sampler(STYLES[style](sample), pdf, UnitSphere(), **SINGLE)
    assert verdict.outcome == "not rejected", str(verdict)


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("name", WRONG)
def test_wrong_narrow_lobes_are_found(name, style):
    sample, pdf = WRONG[name]
    verdict = sampler_check(STYLES[style](sample), pdf, UnitSphere(), **SINGLE).unexplained()
    assert verdict.outcome == "rejected", str(verdict)
    assert any(f.outcome == "rejected" and f.p_value is not None for f in verdict.findings)


def test_what_rounding_hides_is_no_pass():
    shift = np.float32(2e-8)

    def coarse(u):
        v = np.floor(u[:, 0] * np.float32(4)) * shift
        return around(v.astype(np.float32), np.float32(2 * np.pi) * u[:, 1])

    pdf = lambda x: np.where(versine(x) < 8e-8, 1 / (2 * np.pi * 8e-8), 0)  # noqa: E731
    verdict = check_sampler(always_single(coarse), pdf, UnitSphere(), **SINGLE)
    assert verdict.outcome != "not rejected", str(verdict)


def test_numbers_of_few_bits_may_be_0():
    """Among 2^18 numbers of 16 bits some are 0 itself, below which nothing lies."""
    verdict = check_sampler(
        lambda rng, n: rng.integers(0, 1 << 16, n) / 2**16,
        lambda x: np.ones(len(x)), Interval(0, 1), dimensions=None, uniform_bits=16, samples=1 << 18,
    )  # fmt: skip
    assert verdict.outcome == "not rejected", str(verdict)


def cumulated(g):
    def cdf(x):
        low = (1 - g * g) / (2 * g) * (1 / np.sqrt((1 - g) ** 2 + 2 * g * versine(x)) - 1 / (1 + g))
        return np.stack([low, np.arctan2(x[:, 1], x[:, 0]) / (2 * np.pi) % 1], axis=-1)

    return cdf


@pytest.mark.parametrize("hint", ["", "cdf", "inverse"])
@pytest.mark.parametrize("always", [always_single, rounded_at_last])
def test_a_given_cdf_does_not_know_the_points_better_than_they_are(hint, always):
    """Near the peak of g = 0.99 a step of the cosine in single precision is wider than a cell of the cdf: some stay empty."""
    given = {hint: cumulated(0.99)} if hint else {}
    right = check_sampler(always(lobe(0.99, 1, True)), lobe_pdf(0.99), UnitSphere(), **SINGLE, **given)
    assert right.outcome == "not rejected", str(right)
    wrong = sampler_check(always(lobe(0.9893, 1, True)), lobe_pdf(0.99), UnitSphere(), **SINGLE, **given)
    assert wrong.unexplained().outcome == "rejected"


@pytest.mark.parametrize("hint", ["cdf", "inverse"])
def test_points_that_rounding_puts_onto_a_pole_have_no_azimuth_of_their_own(hint):
    """6 % of the samples of g = 0.999 by the textbook: a map of them to the unit cube has one azimuth for all."""
    given, single = {hint: cumulated(0.999)}, SINGLE | {"samples": 100_000}
    right = check_sampler(always_single(lobe(0.999, 1, True)), lobe_pdf(0.999), UnitSphere(), **single, **given)
    assert right.outcome != "rejected", str(right)
    wrong = sampler_check(always_single(lobe(0.999, 0.8, True)), lobe_pdf(0.999), UnitSphere(), **single, **given)
    assert wrong.unexplained().outcome == "rejected"


def test_a_steep_pdf_in_double_precision_is_integrated_as_one():
    """Its change over a rounding of the point is no noise of its own: the expected masses are known."""
    subject = Subject(lobe(0.99, 1, True), lobe_pdf(0.99), UnitSphere(), 2, precision="float32")
    points = subject.sample(np.random.default_rng().random((2048, 2))).astype(np.float64)
    assert pdf_noise(subject, points) < 1e-8
    single = replace(subject, pdf=lambda x: lobe_pdf(np.float32(0.99))(x.astype(np.float32)).astype(np.float64))
    assert pdf_noise(single, points) > 1e-8
