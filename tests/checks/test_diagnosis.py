"""The cause of a rejection is a hypothesis that explains the samples: bugs that shipped are named, what nothing explains is not."""

import random

import numpy as np
import pytest

from fogproof import Box, HalfLine, Interval, SphericalTriangle, UnitSphere, UnitSquare, check_sampler
from fogproof.checks.diagnosis import diagnosed, holes
from fogproof.checks.diagnosis.explaining import setting_of
from fogproof.checks.diagnosis.factors import named_factor
from fogproof.checks.diagnosis.hypothesis import Hypothesis
from fogproof.checks.subject import Subject
from fogproof.zoo import select
from fogproof.zoo.laws import directions, even, hg

N = 200_000


def test_bugs_that_shipped_are_rejected_and_most_are_named():
    """A dozen by chance; `fogproof zoo field` has them all, and the share that is named."""
    seed = int(np.random.SeedSequence().generate_state(1)[0])
    drawn = random.Random(seed).sample(select(["field"]), 12)
    verdicts = [(bug, bug.case.run(1e-6, seed, N)) for bug in drawn]
    assert not [bug.name for bug, verdict in verdicts if verdict.outcome != "rejected"], f"seed {seed}"
    unnamed = [f"{bug.name}: {verdict.cause}" for bug, verdict in verdicts if verdict.cause not in bug.causes]
    assert len(unnamed) <= 3, f"{unnamed}, seed {seed}"


def number(verdict):
    """Return the fitted parameter and its standard error, as the diagnosis tells them."""
    words = verdict.diagnosis.split()
    at = words.index("+-")
    return float(words[at - 1]), float(words[at + 1].rstrip(";,)"))


@pytest.mark.parametrize("g", [0.785, 0.5])
def test_a_parameter_is_fitted_with_its_error(g):
    verdict = check_sampler(hg(g)[0], hg(0.8)[1], UnitSphere(), dimensions=2, samples=1_000_000)
    assert verdict.cause == "another parameter", str(verdict)
    value, error = number(verdict)
    assert error < 0.003
    assert abs(value - g) < 6 * error, verdict.diagnosis


def test_a_rate_is_fitted_with_its_error():
    verdict = check_sampler(
        lambda u: -np.log1p(-u[:, 0]) / 1.03, lambda t: np.exp(-t), HalfLine(0), dimensions=1, samples=500_000
    )
    assert verdict.cause == "wrong scale", str(verdict)
    value, error = number(verdict)
    assert abs(value - 1.03) < 6 * error, verdict.diagnosis


def test_what_nothing_explains_is_not_named():
    def sample(u):
        x = u[:, 0]
        return x + 0.002 * np.sin(60 * np.pi * x) / (60 * np.pi) * 30

    verdict = check_sampler(sample, lambda x: np.ones(len(x)), Interval(0, 1), dimensions=1, samples=1_000_000)
    assert verdict.outcome == "rejected"
    assert verdict.cause == "shape", str(verdict)
    assert not verdict.diagnosis


def test_a_band_is_skipped_only_if_its_absence_explains_the_misfit():
    def band(u):
        return np.where(np.abs(u[:, 0] - 0.4) < 0.01, u[:, 1], u[:, 0])

    ones = lambda x: np.ones(len(x))  # noqa: E731
    skipped = check_sampler(band, ones, Interval(0, 1), dimensions=2, samples=N)
    assert skipped.cause == "skipped band", str(skipped)
    ends = [float(word) for word in skipped.diagnosis.replace(";", " ").split() if word[:2] == "0."]
    assert np.allclose(ends, [0.39, 0.41], atol=1e-3), skipped.diagnosis
    notched = check_sampler(lambda u: u, lambda x: 4 * x[:, 0] * x[:, 1], UnitSquare(), dimensions=2, samples=N)
    assert notched.cause == "uniform law", "the least likely cells lack most samples, but no band explains it"


def test_a_right_sampler_has_no_cause():
    verdict = check_sampler(
        lambda u: directions(2 * u[:, 0] - 1, u[:, 1]), even, UnitSphere(), dimensions=2, samples=20_000
    )
    assert (verdict.cause, verdict.diagnosis) == ("", "")


@pytest.mark.parametrize(("value", "error", "name"), [
    (4 * np.pi, 1e-6, "4 pi"),
    (453.0, 70.0, ""),
    (12.0, 0.6, ""),
    (np.pi / 4, 1e-7, "pi/4"),
    (0.6, 1e-7, "the albedo"),
    (1.0, 1e-7, ""),
    (np.nan, 1e-7, ""),
])  # fmt: skip
def test_a_constant_is_named_only_where_it_is_pinned(value, error, name):
    assert named_factor(value, error, {"the albedo": 0.6}) == name


def test_the_line_that_reproduces_a_verdict_runs():
    import fogproof

    def sample(u):
        return np.where(u[:, 0] < 0.3, 1.0, u[:, 0])

    def pdf(x):
        return np.full(len(x), 0.8)

    verdict = check_sampler(sample, pdf, Interval(0, 1), dimensions=1, atoms={1.0: 0.2}, samples=5000)
    again = eval(verdict.reproduce, {**vars(fogproof), "check_sampler": check_sampler, "sample": sample, "pdf": pdf})
    assert verdict.outcome == "rejected"
    assert [(f.check, f.p_value) for f in again.findings] == [(f.check, f.p_value) for f in verdict.findings]


def test_the_claim_is_asked_once_at_the_points_that_every_hypothesis_weighs():
    points, asked = UnitSphere(), []

    def pdf(x):
        asked.append(len(x))
        return np.full(len(x), 0.25 / np.pi)

    subject = Subject(lambda u: points.law(np.empty((0, 3))).place(u), pdf, points, 2)
    setting = setting_of(subject, 1 << 12, 1)
    whole = setting.contrast.points
    assert asked.count(len(whole)) == 1
    asked.clear()
    first = setting.p(whole)
    for hypothesis in holes.hypotheses(setting):
        hypothesis.density(setting, 0.1)(whole)
    assert setting.p(whole) is first
    assert not asked
    few = setting.part(99)
    assert not asked
    assert np.array_equal(few.values, few.claim(few.contrast.points))
    assert np.array_equal(setting.p(whole[:5]), first[:5])


def twisted(u):
    """Three coordinates of which each two are independent, and all three are not."""
    return np.stack([u[:, 0], u[:, 1], (u[:, 0] + u[:, 1] + 0.1 * u[:, 2]) % 1], axis=1)


@pytest.mark.parametrize(("sample", "factor", "cause"), [
    (twisted, 1.0, "shape"),
    (lambda u: u, 1.3, "normalisation"),
])  # fmt: skip
def test_an_integral_is_the_cause_only_if_points_of_the_known_law_show_it(sample, factor, cause):
    cube = Box([0] * 3, [1] * 3)
    verdict = check_sampler(sample, lambda x: np.full(len(x), factor), cube, dimensions=3, samples=20_000)
    assert verdict.cause == cause, str(verdict)


def test_a_narrow_lobe_is_no_atom():
    def sample(rng, n):
        return np.where(rng.random(n) < 2e-3, 0.37 + 1e-7 * rng.random(n), rng.random(n))

    ones = lambda x: np.ones(len(x))  # noqa: E731
    lobe = check_sampler(sample, ones, Interval(0, 1), dimensions=None, samples=N)
    assert (lobe.outcome, lobe.cause) == ("rejected", "shape"), str(lobe)
    atom = check_sampler(
        lambda rng, n: np.where(rng.random(n) < 2e-3, 0.37, rng.random(n)),
        ones,
        Interval(0, 1),
        dimensions=None,
        samples=N,
    )
    assert atom.cause == "atom", str(atom)


@pytest.mark.parametrize(("value", "error", "cause"), [
    (-1.003, 0.01, "missing Jacobian"),
    (0.5, 1e-4, "missing Jacobian"),
    (0.0413, 0.005, "wrong power"),
    (0.66, 0.005, "wrong power"),
    (1.1, 0.3, "wrong power"),
])  # fmt: skip
def test_nobody_forgets_a_factor_to_an_odd_power(value, error, cause):
    power = Hypothesis("missing Jacobian", "", lambda s, a: s.p, (1.0,), otherwise="wrong power")
    assert power.caused(value, error) == cause


def test_points_of_a_plane_are_told_from_those_of_a_cube():
    corners = np.eye(3)
    triangle = SphericalTriangle(*map(tuple, corners))

    def sample(u):
        s = np.sqrt(u[:, 0])
        x = np.stack([1 - s, s * (1 - u[:, 1]), s * u[:, 1]], axis=1) @ corners
        return x / np.linalg.norm(x, axis=1, keepdims=True)

    verdict = check_sampler(sample, lambda x: np.full(len(x), 2 / np.pi), triangle, dimensions=2, samples=100_000)
    assert verdict.cause == "missing Jacobian", str(verdict)
    assert "area of a plane" in verdict.diagnosis


def test_a_logarithm_and_what_is_no_number_are_named():
    def checked(pdf):
        return check_sampler(lambda u: np.sqrt(u[:, 0]), pdf, Interval(0, 1), dimensions=1, samples=20_000)

    logarithm = checked(lambda x: np.log(2 * x))
    assert logarithm.cause == "negative pdf"
    assert "logarithm" in logarithm.diagnosis
    assert "logarithm" not in checked(lambda x: 2 * x - 0.1).diagnosis
    assert checked(lambda x: np.where(x < 0.1, np.nan, 2 * x)).cause == "not a number"


def test_a_wrong_mean_cosine_is_no_wrong_shape():
    verdict = check_sampler(*hg(0.5), UnitSphere(), dimensions=2, samples=20_000, axis=(0, 0, 1), mean_cosine=0.6)
    assert verdict.cause == "wrong mean cosine", str(verdict)


def test_the_line_that_reproduces_a_verdict_needs_no_numpy():
    mirror = tuple(np.array([0.6, 0.0, 0.8]))
    verdict = check_sampler(
        lambda u: np.where(u[:, :1] < 0.5, mirror, directions(2 * u[:, 0] - 1, u[:, 1])),
        lambda x: 0.5 * even(x), UnitSphere(), dimensions=2, atoms={mirror: 0.5}, samples=1000,
    )  # fmt: skip
    assert "atoms={(0.6, 0.0, 0.8): 0.5}" in verdict.reproduce


def test_the_search_for_a_cause_ends_in_time():
    """A slow subject: it is asked no more when its time is over, and the verdict keeps the cause that its findings name."""
    asked = []

    def pdf(x):
        asked.append(len(x))
        return hg(0.8)[1](x)

    verdict = check_sampler(hg(0.5)[0], pdf, UnitSphere(), dimensions=2, samples=100_000)
    subject = Subject(hg(0.5)[0], pdf, UnitSphere(), 2)
    asked.clear()
    named, words = diagnosed(subject, verdict.findings, verdict.samples, verdict.seed, 0.0)
    assert named in {f.cause for f in verdict.findings}
    assert "was ended after 0 s" in words
    assert not asked
    assert diagnosed(subject, verdict.findings, verdict.samples, verdict.seed) == (verdict.cause, verdict.diagnosis)
