"""A verdict cannot be misread: it has no truth value, and what it could not decide is no pass."""

import numpy as np
import pytest

from fogproof import Draws, Reference, check_estimator
from fogproof.checks import Finding, InconclusiveError, RejectedError, Verdict
from fogproof.errors import FogproofError, InvalidValueError


def verdict(*outcomes):
    findings = tuple(Finding(f"check {i}", outcome, "a sentence") for i, outcome in enumerate(outcomes))
    return Verdict(findings, 1e-6, 1000, 1)


@pytest.mark.parametrize("outcome", ["rejected", "inconclusive", "not rejected"])
def test_a_verdict_is_neither_true_nor_false(outcome):
    for misuse in (lambda v: bool(v), lambda v: not v, lambda v: v and 1):
        with pytest.raises(FogproofError, match=r"raise_unless_passed\(\)"):
            misuse(verdict("not rejected", outcome))


@pytest.mark.parametrize(
    ("outcomes", "error"),
    [
        (("not rejected",), None),
        (("not rejected", "rejected", "inconclusive"), RejectedError),
        (("not rejected", "inconclusive"), InconclusiveError),
    ],
)
def test_only_a_pass_passes(outcomes, error):
    if error is None:
        verdict(*outcomes).raise_unless_passed()
        return
    with pytest.raises(error, match="a sentence") as caught:
        verdict(*outcomes).raise_unless_passed()
    assert isinstance(caught.value, AssertionError)


def uniform(rng, n):
    return rng.random(n)


def test_plain_numbers_are_references():
    for reference in (0.5, np.float32(0.5), Reference(0.5), Reference(0.5, error=1e-9)):
        assert check_estimator(uniform, reference, samples=20_000).outcome == "not rejected"
    assert check_estimator(uniform, 0.6, samples=20_000).outcome == "rejected"
    three = check_estimator(lambda rng, n: rng.random((n, 3)) * [1, 2, 4], [0.5, 1, 2], samples=20_000)
    assert three.outcome == "not rejected"
    assert float(Reference(0.5)) == 0.5
    with pytest.raises(InvalidValueError, match="single number"):
        float(Reference([0.5, 1.0]))


NAN = float("nan")


@pytest.mark.parametrize(
    "call",
    [
        lambda: check_estimator(uniform, Reference(NAN), samples=1000),
        lambda: check_estimator(uniform, Reference(0.5, NAN), samples=1000),
        lambda: Reference(0.5, -1e-9),
        lambda: Reference("0.5"),
        lambda: check_estimator(uniform, NAN, samples=1000),
        lambda: check_estimator(uniform, [0.5, NAN], samples=1000),
        lambda: check_estimator(uniform, Reference(np.inf), samples=1000),
        lambda: check_estimator(uniform, Reference(0.5, np.inf), samples=1000),
        lambda: check_estimator(uniform, 0.5, variance=NAN, samples=1000),
        lambda: check_estimator(uniform, 0.5, variance=-1.0, samples=1000),
        lambda: check_estimator(lambda rng, n: Draws(rng.random(n), np.ones(n)), 0.5, cost=NAN, samples=1000),
    ],
)
def test_references_that_mean_nothing_are_refused(call):
    with pytest.raises(InvalidValueError):
        call()


@pytest.mark.parametrize("part", ["cost", "stderr"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_one_bad_number_in_any_part_rejects(part, bad):
    def draw(rng, n):
        column = np.full(n, 7.0)
        column[n // 2] = bad
        return Draws(rng.random(n), **{part: column})

    found = check_estimator(draw, 0.5, samples=20_000, cost=7.0 if part == "cost" else None)
    assert found.outcome == "rejected", str(found)
    assert found.findings[0].check == "finite values"
