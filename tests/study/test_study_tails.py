"""What heavy tails and rare values leave open: intervals that hold, times without an end, and no advice that never ends."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from study_levels import MEAN, Law, cell, level, normal

from fogproof.checks.statistics.tails import binomial_at_least
from fogproof.contracts import Reference
from fogproof.study.aggregate import pooled
from fogproof.study.judgement import judge
from fogproof.study.measures import measure
from fogproof.study.methods import table as methods
from fogproof.study.tails import beyond

COUNTS = (100, 1000, 4000)
TRIES = 12


def pareto(index):
    """Return draws of a law with the variance 1 and tails like x^-index."""
    mean, variance = index / (index - 1), index / ((index - 1) ** 2 * (index - 2))
    return lambda rng, shape: (1 + rng.pareto(index, shape) - mean) / math.sqrt(variance)


def lognormal(rng, shape):
    return (rng.lognormal(0, 1, shape) - math.exp(0.5)) / math.sqrt(math.e * (math.e - 1))


def exponential(rng, shape):
    return rng.exponential(size=shape) - 1


def found(law, rng):
    one, levels = cell(), [level(MEAN * (1 + law(rng, (32, count)))) for count in COUNTS]
    object.__setattr__(one, "method", type(one.method)(law))
    return measure(one, levels, 1e-9)


@pytest.fixture(autouse=True)
def _known(monkeypatch):
    monkeypatch.setitem(methods.METHODS, "law", Law)


@pytest.mark.parametrize("law", [pareto(2.5), pareto(3), pareto(4.5), lognormal, exponential, normal])
def test_intervals_of_the_variance_hold(law):
    """That of a sample is mostly too small where it hangs on few of the values. Times have no end where it has none."""
    rng, missed = np.random.default_rng(), 0
    for _ in range(TRIES):
        one = found(law, rng)
        told, target = one.record["variance"], one.record["speed"]["targets"][0]
        missed += not told["low"] <= MEAN**2 <= told["high"]
        if told["high"] == math.inf:
            assert (target["unless"], target["high"]) == ("rare", math.inf)
    assert binomial_at_least(missed, TRIES, 0.01) > 1e-6


@pytest.mark.parametrize(("law", "most"), [(normal, 0.02), (exponential, 0.06)])
def test_a_light_tail_widens_nothing(law, most):
    told = found(law, np.random.default_rng()).record["variance"]
    assert told["high"] / told["measured"] - 1 < most


def rare(size, often):
    """Return what is `size` times too large once in so many, and too small by just what that adds."""
    return lambda rng, shape: size * ((rng.random(shape) < 1 / often) - 1 / often)


def test_a_rare_value_that_was_not_met_leaves_no_time_to_an_error_an_end():
    one = found(rare(1000.0, 1e12), np.random.default_rng())
    assert (one.status, one.record["moments"]["m2"]) == ("inconclusive", 0)
    assert [(t["how"], t["unless"], t["low"], t["high"]) for t in one.record["speed"]["targets"]] == [
        ("less-than", "rare", 0, math.inf)
    ] * 3


def test_hits_that_never_missed_may_miss_as_often_as_would_not_have_been_seen(monkeypatch):
    """Bounds decide about the mean to some per cent: to a smaller error no time has an end, unless the variance is known."""
    monkeypatch.setitem(methods.METHODS, "bounded", Bounded)
    one, hits = cell(), [level(np.full((32, n), MEAN * (1 + 1e-6))) for n in COUNTS]
    for variance, unless in ((None, ["rare"] * 3), (Reference(np.asarray(1e-6)), ["", "", ""])):
        object.__setattr__(one, "method", Bounded(lambda rng, n: 0.0, variance))
        found = measure(one, hits, 1e-9)
        assert found.status == "passed"
        assert [t["unless"] for t in found.record["speed"]["targets"]] == unless


@dataclass(frozen=True)
class Bounded(Law):
    known: Reference | None = None

    def bounds(self, scene):
        return 0.0, MEAN * (1 + 1e-6)

    def variance(self, scene):
        return self.known


@pytest.mark.parametrize(("law", "lacks"), [(pareto(2.2), "tail"), (rare(300.0, 1e5), "law")])
def test_more_samples_are_not_asked_for_where_none_may_be_enough(law, lacks):
    rng = np.random.default_rng()
    judged = judge(cell(), [level(MEAN * (1 + law(rng, (32, n)))) for n in COUNTS], None, 1e-9)
    assert (judged.lacks, judged.rare) == (lacks, True)
    assert (judged.times_as_many > 1) == (lacks == "law")


def test_a_few_values_above_a_bulk_are_no_power_law():
    """All hits are worth the same: nothing further out is foretold."""
    rng = np.random.default_rng()
    x = MEAN * np.where(rng.random((32, 4000)) < 3e-4, 100.0, 1 + 0.01 * rng.normal(size=(32, 4000)))
    assert beyond([level(x)], pooled(level(x).rows), MEAN) == 0.0
