"""What came instead of numbers is named, with what mends it; a plan and a headline are about what was asked for."""

import warnings
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from fogproof import (
    Interval,
    InvalidValueError,
    check_bound,
    check_convergence,
    check_estimator,
    check_streams,
    samples_for,
)
from fogproof.errors import SubjectError


def yields(rng, n):
    yield from rng.random(n)


async def awaits(rng, n):
    return rng.random(n)


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (lambda rng, n: None, "None; does draw end without a return"),
        (yields, "a generator; collect what it yields"),
        (lambda rng, n: map(float, rng.random(n)), "a map; collect what it yields"),
        (awaits, "a coroutine; draw must be a plain function"),
        (lambda rng, n: {"value": rng.random(n)}, "a dict; return its values as an array"),
        (lambda rng, n: [Fraction(1, 3)] * n, "dtype object; convert them"),
        (lambda rng, n: [Decimal(1)] * n, "dtype object; convert them"),
    ],
)
def test_what_is_no_array_of_numbers(draw, words):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(SubjectError, match=words):
            check_estimator(draw, 0.5, samples=1000)


def test_a_plan_is_made_of_what_can_be_planned():
    with pytest.raises(InvalidValueError, match="channels must be a whole number >= 1"):
        samples_for(bias=0.1, variance=1.0, channels=3.5)
    with pytest.raises(InvalidValueError, match="bounds must be finite to plan by them"):
        samples_for(bias=0.1, bounds=(0.0, np.inf))


@pytest.mark.parametrize("reference", [0.5, None])
def test_the_headline_of_convergence_is_about_the_most_samples(reference):
    verdict = check_convergence(lambda rng, n: rng.random(n).mean(), [10, 100, 10_000], reference=reference)
    assert "10000" in verdict.resolution.kind
    stated = [finding.resolution for finding in verdict.findings if finding.resolution is not None]
    if reference is not None:
        assert verdict.resolution.value == min(each.value for each in stated) < 0.05


def test_the_first_of_streams_that_overlap_is_named():
    verdict = check_streams(lambda i: np.random.Generator(np.random.PCG64(5).advance(i)), 64)
    assert "the first in streams 0 and 1" in str(verdict)


def test_what_may_not_be_infinite_says_so():
    with pytest.raises(InvalidValueError, match="variance must be > 0 and finite, got inf"):
        samples_for(bias=0.1, variance=np.inf)
    with pytest.raises(InvalidValueError, match="bound must be >= 0 and finite, got inf"):
        check_bound(lambda x: x, np.inf, Interval(0.0, 1.0))
    with pytest.raises(InvalidValueError, match=r"false_fail must lie in \(0, 1\), got inf"):
        samples_for(bias=0.1, variance=1.0, false_fail=np.inf)
