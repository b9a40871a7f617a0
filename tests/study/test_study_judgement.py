"""What is missing, or has no variance, leaves a judgement open; intervals are no wider than what they are to hold."""

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from study_levels import COUNTS, MEAN, Law, cell, level, normal

from fogproof.contracts import Reference
from fogproof.study.batches import COLUMNS, draw_batch
from fogproof.study.convergence import Z, order_of
from fogproof.study.judgement import inherited, judge
from fogproof.study.measures import measure
from fogproof.study.methods import table as methods
from fogproof.study.plan import batches_of


def levels(off):
    rng = np.random.default_rng()
    return [level(MEAN + off(rng, (16, count))) for count in COUNTS]


def test_what_is_there_is_judged_and_what_is_missing_leaves_it_open():
    whole = levels(normal)
    assert judge(cell(), whole, None, 1e-9).outcome == "not rejected"
    holed = [whole[0], replace(whole[1], rows=whole[1].rows[:-1])]
    for part in (holed, whole[:1]):
        judged = judge(cell(), part, None, 1e-9)
        assert judged.outcome == "inconclusive"
        assert [f.check for f in judged.findings if f.outcome == "inconclusive"] == ["completeness"]


def test_a_mean_without_a_variance_is_not_judged_and_says_why():
    judged = judge(cell(), levels(lambda rng, shape: rng.standard_t(0.7, size=shape)), None, 1e-9)
    assert judged.infinite
    assert judged.outcome == judged.findings[0].outcome == "inconclusive"
    assert "infinite variance suspected" in judged.findings[0].message


def test_what_would_not_have_shown_an_error_as_large_as_the_reference_is_not_called_unbiased():
    rng = np.random.default_rng()
    few = np.zeros((16, COUNTS[1]))
    few[[0, 3, 7], 5] = 16 * COUNTS[1] / 3
    judged = judge(cell(), [level(MEAN * few)], None, 1e-9)
    assert (judged.outcome, judged.lacks) == ("inconclusive", "resolution")
    assert "an error as large as the reference itself" in judged.findings[0].message
    assert judged.times_as_many == (judged.findings[0].resolution.value / MEAN) ** 2 > 10
    for spread, lacks in ((0.1 * math.sqrt(COUNTS[1]), ""), (100.0, "resolution")):
        wide = [level(MEAN + spread * MEAN * rng.normal(size=(16, n))) for n in COUNTS]
        assert judge(cell(), wide, None, 1e-9).lacks == lacks


def test_sobol_points_inherit_what_random_ones_are_rejected_for():
    """Dependence is no bias: of Sobol points it is told by its name too."""
    right = judge(cell(), levels(normal), None, 1e-9)
    rng = np.random.default_rng()
    alike = [level(MEAN + np.broadcast_to(rng.normal(size=(16, 1)), (16, n)).copy()) for n in COUNTS]
    dependent, biased = (
        judge(cell(), alike, None, 1e-9),
        judge(cell(), levels(lambda rng, shape: 1 + normal(rng, shape)), None, 1e-9),
    )
    assert inherited(right, dependent).wrong == dependent.wrong == {"scatter of replicates"}
    assert inherited(right, biased).wrong == {"random points"}


@pytest.mark.parametrize("off", [4.4e-16, -4.4e-16, 0.0])
@pytest.mark.parametrize("jitter", [0.0, 4.4e-16])
def test_a_variance_of_0_is_right_of_what_is_right_to_rounding(off, jitter):
    """The reference and sums in another order are off by more than binary64's last digit; an error above that is found."""
    rng, none = np.random.default_rng(), Reference(np.asarray(0.0))

    near = [level(MEAN + off + jitter * rng.integers(2, size=(16, n))) for n in COUNTS]
    assert judge(cell(), near, none, 1e-9).outcome == "not rejected"
    varies = [level(MEAN + 1e-9 * rng.normal(size=(16, n))) for n in COUNTS]
    assert judge(cell(), varies, none, 1e-9).wrong == {"variance"}
    beside = [level(np.full((16, n), MEAN + 1e-10)) for n in COUNTS]
    assert "mean" in judge(cell(), beside, none, 1e-9).wrong


def test_rounding_is_no_error_of_a_tiny_variance():
    """It changes the root of a variance by as much as it moves the realisations."""
    rng, tiny = np.random.default_rng(), 1e-14
    drawn = [level(MEAN + tiny * rng.normal(size=(16, n))) for n in COUNTS]
    for deviation, wrong in ((tiny, False), (0.9 * tiny, False), (1e-9, True)):
        judged = judge(cell(), drawn, Reference(np.asarray(deviation**2)), 1e-9)
        assert ("variance" in judged.wrong) == wrong


def test_few_values_of_a_normal_law_are_few_and_not_skewed():
    rng = np.random.default_rng()
    judged = judge(cell(), [level(MEAN + 0.1 * rng.normal(size=(32, n))) for n in (1, 2)], None, 1e-9)
    assert (judged.outcome, judged.lacks) == ("inconclusive", "samples")
    assert judged.times_as_many >= 100 / 96
    skewed = judge(cell(), [level(rng.exponential(size=(16, n))) for n in (16, 64)], None, 1e-9)
    assert skewed.lacks == "law"


def test_deviations_are_from_the_reference(monkeypatch):
    """An estimator that is off by three standard deviations errs by that, whatever its variance."""
    monkeypatch.setitem(methods.METHODS, "law", Law)
    shift = 3.0
    one = cell(lambda rng, n: shift + rng.normal(size=n))
    batch = next(batch for batch in batches_of([one]) if batch.size == COUNTS[1])
    result = draw_batch(one, batch, MEAN)
    square = dict(zip(COLUMNS, result.moments[-1], strict=True))
    expected = 1 + shift**2
    spread = math.sqrt((2 + 4 * shift**2) / square["n"])
    assert abs(square["mean"] - expected) < 7 * spread


@dataclass(frozen=True)
class Declared(Law):
    """A law that is declared to be biased."""

    bias: ClassVar[str] = "by construction"


@pytest.mark.parametrize(("method", "how"), [(Declared, "never"), (Law, "not-reached")])
def test_a_declared_bias_that_is_a_mere_constant_is_there_for_good(monkeypatch, method, how):
    """Without the declaration rare values may be missing, and the error may fall."""
    monkeypatch.setitem(methods.METHODS, "law", method)
    one = cell()
    object.__setattr__(one, "method", method(normal))
    alike = [level(np.full((16, n), 1.005 * MEAN)) for n in COUNTS]
    assert [t["how"] for t in measure(one, alike, 1e-9).record["speed"]["targets"]] == ["less-than", how, how]


@pytest.mark.parametrize("freedom", [4.0, 16.0, 64.0])
def test_the_interval_of_an_order_is_as_wide_as_the_order_scatters(freedom):
    rng, counts = np.random.default_rng(), np.array([100, 1000, 10_000, 100_000])
    noise = np.sqrt(rng.chisquare(freedom, size=(1500, 4)) / freedom)
    found = [order_of(counts, row / np.sqrt(counts), np.full(4, freedom), np.zeros(4)) for row in noise]
    whole = [one for one in found if one is not None and one.points == 4]
    told = np.mean([(one.high - one.low) / 2 for one in whole]) / Z
    assert len(whole) > 1300
    assert told == pytest.approx(np.std([one.value for one in whole]), rel=0.15)
