"""Realisations of a call that depend on each other are called so, and nothing said of the mean takes them as independent."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scipy.signal import lfilter
from study_levels import COUNTS, MEAN, Law, cell, level

from fogproof.checks.statistics.tails import binomial_at_least
from fogproof.contracts import Reference
from fogproof.study import judgement
from fogproof.study.between_replicates import between_replicates
from fogproof.study.judgement import judge
from fogproof.study.measures import measure
from fogproof.study.methods import table as methods
from fogproof.study.replicate_means import judged_by_replicates

ALPHA = 1e-8

INDEPENDENT = {
    "normal": lambda rng, shape: rng.normal(size=shape),
    "exponential": lambda rng, shape: rng.exponential(size=shape) - 1,
    "lognormal": lambda rng, shape: np.exp(rng.normal(size=shape)) - math.exp(0.5),
    "halves": lambda rng, shape: (rng.random(shape) < 0.5) - 0.5,
    "rare": lambda rng, shape: (rng.random(shape) < 0.02) - 0.02,
    "counts": lambda rng, shape: rng.poisson(2.0, shape) - 2.0,
}


def each(draw):
    """Return a law of whole calls, of what draws one."""
    return lambda rng, shape: np.stack([draw(rng, shape[1]) for _ in range(shape[0])])


def folded(rng, n):
    u = rng.random(n // 2)
    return np.concatenate([u, 1 - u]) - 0.5


DEPENDENT = {
    "one number a call": lambda rng, shape: np.broadcast_to(rng.normal(size=(shape[0], 1)), shape).copy(),
    "one skewed number a call": lambda rng, shape: np.broadcast_to(rng.exponential(size=(shape[0], 1)) - 1, shape).copy(),
    "all or nothing": lambda rng, shape: np.broadcast_to((rng.random((shape[0], 1)) < 0.5) - 0.5, shape).copy(),
    "a factor in common": lambda rng, shape: rng.exponential(size=shape) * np.exp(0.5 * rng.normal(size=(shape[0], 1)) - 0.125) - 1,
    "sixteen alike": lambda rng, shape: np.repeat(rng.normal(size=(shape[0], shape[1] // 16)), 16, axis=1),
}  # fmt: skip


def neighbours(correlation):
    """Return a law of unit variance whose neighbours are so correlated: means vary (1 + r) / (1 - r) times as much."""

    def draw(rng, shape):
        x = math.sqrt(1 - correlation**2) * rng.normal(size=shape)
        x[:, 0] = rng.normal(size=shape[0])
        return lfilter([1], [1, -correlation], x, axis=1)

    return draw


STRATIFIED = {
    "antithetic pairs": each(folded),
    "strata": each(lambda rng, n: (np.arange(n) + rng.random(n)) / n - 0.5),
    "strata of a skewed law": each(lambda rng, n: -np.log1p(-(np.arange(n) + rng.random(n)) / n) - 1),
}


def levels(law, rng, counts=COUNTS, replicates=16, off=0.0):
    return [level(MEAN + off + law(rng, (replicates, n))) for n in counts]


@pytest.mark.parametrize("law", INDEPENDENT)
def test_independent_realisations_are_found_dependent_no_more_often_than_alpha(law):
    rng, alpha, tries = np.random.default_rng(), 0.02, 250
    found = [between_replicates(levels(INDEPENDENT[law], rng, (16, 128), 8), alpha) for _ in range(tries)]
    wrong = sum(one.by_replicates for one in found)
    assert binomial_at_least(wrong, tries, alpha) > 1e-9, wrong
    doubted = sum(one.calls == "doubtful" for one in found)
    assert binomial_at_least(doubted, tries, 0.03) > 1e-9, doubted


@pytest.mark.parametrize("law", DEPENDENT)
def test_dependent_realisations_are_rejected_as_such_and_for_no_bias(law):
    rng = np.random.default_rng()
    judged = judge(cell(), levels(DEPENDENT[law], rng), None, ALPHA)
    assert (judged.calls, judged.wrong) == ("dependent", {"scatter of replicates"})
    shifted = judge(cell(), levels(DEPENDENT[law], rng, off=300.0), None, ALPHA)
    assert shifted.wrong == {"scatter of replicates", "mean"}


@pytest.mark.parametrize("law", STRATIFIED)
def test_stratified_calls_are_right_and_judged_by_their_means(law):
    rng = np.random.default_rng()
    judged = judge(cell(), levels(STRATIFIED[law], rng), None, ALPHA)
    assert (judged.calls, judged.outcome) == ("stratified", "not rejected")
    shifted = judge(
        cell(), levels(STRATIFIED[law], rng, off=0.01), None, ALPHA
    )  # far less than a realisation's standard error
    assert shifted.wrong == {"mean"}
    declared = judge(
        cell(), levels(STRATIFIED[law], rng), Reference(np.var(STRATIFIED[law](rng, (1, 1 << 18))), 0.01, "", ""), ALPHA
    )
    assert declared.outcome == "not rejected", declared.findings


@pytest.mark.parametrize("law", [*DEPENDENT, *STRATIFIED])
def test_the_interval_of_the_bias_is_that_of_replicates(monkeypatch, law):
    """Of skewed numbers, one a call, Student's interval is short on one side: of sixteen, some per cent of intervals."""
    monkeypatch.setitem(methods.METHODS, "law", Law)
    rng, tries = np.random.default_rng(), 50
    found = [measure(cell(), levels({**DEPENDENT, **STRATIFIED}[law], rng), ALPHA).record for _ in range(tries)]
    for one in found:
        interval = one["findings"][0].interval
        assert interval is None or (interval.low, interval.high) == pytest.approx(
            (one["bias"]["low"], one["bias"]["high"]), rel=1e-9, abs=1e-10
        )
    told = [one["bias"] for one in found if one["calls"] in ("dependent", "stratified")]
    missed = sum(not one["low"] <= 0 <= one["high"] for one in told)
    assert len(told) > 0.9 * tries
    assert binomial_at_least(missed, len(told), 0.06 if "skewed" in law or "factor" in law else 0.012) > 1e-6, missed
    assert all(one["variance"] is None for one in found if one["calls"] in ("dependent", "stratified"))


def test_correlation_too_weak_to_be_told_leaves_intervals_that_hold(monkeypatch):
    """Neighbours correlated by 0.3: the intervals of independent realisations miss 6 %."""
    monkeypatch.setitem(methods.METHODS, "law", Law)
    rng, tries, law = np.random.default_rng(), 300, neighbours(0.3)
    found = [measure(cell(), levels(law, rng, (64, 512), 16), ALPHA).record for _ in range(tries)]
    told = [one for one in found if one["calls"] in ("independent", "doubtful")]
    missed = sum(not one["bias"]["low"] <= 0 <= one["bias"]["high"] for one in told)
    assert len(told) > 0.95 * tries
    assert binomial_at_least(missed, len(told), 0.018) > 1e-4, missed
    for one in told:
        interval, bias = one["findings"][0].interval, one["bias"]
        ends = bias["low"], bias["high"]
        assert (interval.low, interval.high) == pytest.approx(ends, abs=0.01 * (ends[1] - ends[0]))


def test_times_of_what_may_depend_hold_what_its_means_need(monkeypatch):
    """Neighbours correlated by 0.3: 1.86 times as many samples are needed as the variance of one tells."""
    monkeypatch.setitem(methods.METHODS, "law", Law)
    rng, high, needed = np.random.default_rng(), [], []
    for _ in range(60):
        drawn = levels(neighbours(0.3), rng, (64, 512), 16)
        one = measure(
            cell(), [replace(level, seconds=1e-6 * level.count * np.ones(2)) for level in drawn], ALPHA
        ).record
        target = one["speed"]["targets"][0]
        if target["how"] == "extrapolated":
            needed.append(target["samples"])
            high.append(target["high"])
    assert len(high) > 40
    assert np.median(needed) == pytest.approx((1 / (0.01 * MEAN)) ** 2, rel=0.1)
    assert np.median(high) > 1.5 * 1e-6 * np.median(needed)


def test_a_resolution_grows_with_what_means_scatter():
    """Numbers of which each is there twice: means vary twice as much, and a bias must be larger to be found as surely."""
    rng = np.random.default_rng()
    ratio = []
    for _ in range(40):
        x = [rng.normal(size=(8, n)) for n in COUNTS]
        twice = [np.concatenate([y[:, : y.shape[1] // 2]] * 2, axis=1) for y in x]
        alone, both = (judge(cell(), [level(MEAN + y) for y in some], None, ALPHA) for some in (x, twice))
        ratio.append(both.findings[0].resolution.value / alone.findings[0].resolution.value)
    assert np.median(ratio) > 1.15


def test_calls_that_may_be_stratified_are_told_so_and_judged_as_independent():
    """Antithetic pairs, few replicates: their means are too even for one cell in a hundred, if not for the study's alpha."""
    rng = np.random.default_rng()
    for _ in range(40):
        x = [np.stack([np.exp(folded(rng, n)) for _ in range(6)]) - 2 * math.sinh(0.5) for n in COUNTS]
        judged = judge(cell(), [level(MEAN + y) for y in x], None, 1e-20)
        assert (judged.calls, judged.outcome) == ("independent", "not rejected")
        interval, data = judged.findings[0].interval, np.concatenate([y.ravel() for y in x])
        reach = stats.norm.ppf(0.995) * data.std() / math.sqrt(data.size)
        assert (interval.high - interval.low) / 2 == pytest.approx(reach, rel=1e-2)
        assert "may be stratified" in judged.findings[-1].message


def test_as_many_hits_in_each_call_are_no_strata_if_chance_makes_them():
    """Of 64 tosses four times 32 come once in 2000 times: no lattice is finer than one realisation."""
    hits = np.tile(np.arange(64) % 2 - 0.5, (4, 1))
    assert between_replicates([level(MEAN + hits)], 1e-4).calls == "independent"
    assert between_replicates([level(MEAN + np.tile(hits, (8, 64)))], 1e-4).calls == "stratified"


def test_what_is_stratified_and_then_alike_and_off_is_not_called_right():
    strata = level(MEAN + STRATIFIED["strata"](np.random.default_rng(), (16, 4096)))
    alike = level(np.full((16, 8192), MEAN + 0.1))
    judged = judge(cell(), [strata, alike], None, ALPHA)
    assert (judged.calls, judged.outcome) == ("stratified", "inconclusive")


def test_doubtful_calls_reject_no_mean_that_their_replicates_do_not():
    """Pairs of equal realisations, few calls: their means scatter 1.4 times too much, less than alpha lets be seen."""
    rng = np.random.default_rng()
    pairs = [np.repeat(rng.normal(size=(6, n // 2)), 2, axis=1) for n in COUNTS]
    means = np.array([x.mean(axis=1) for x in pairs])
    spread = [np.sqrt(6 / n) / row.std(ddof=1) for row, n in zip(means, COUNTS, strict=True)]
    wide = [  # the same scatter in every run: 2.4 times too much
        x + (row.mean() + (row - row.mean()) * s - row)[:, None] for x, row, s in zip(pairs, means, spread, strict=True)
    ]
    off = 6.5 / math.sqrt(6 * sum(COUNTS)) - np.average([x.mean() for x in wide], weights=COUNTS)
    judged = judge(cell(), [level(MEAN + off + x) for x in wide], None, ALPHA)
    assert (judged.calls, judged.outcome) == ("doubtful", "inconclusive")
    assert "may depend on each other" in judged.findings[0].message


def test_a_bias_of_the_stated_resolution_is_found():
    rng, tries, found = np.random.default_rng(), 300, 0
    for _ in range(tries):
        means = rng.normal(size=8)
        told = judged_by_replicates("mean", means, 0.0, 0.0, 1e-3).resolution.value
        # The resolution is that of a scatter as measured: of normal means with this standard deviation.
        again = rng.normal(told, means.std(ddof=1), 8)
        t = again.mean() / again.std(ddof=1) * math.sqrt(8)
        found += 2 * stats.t.sf(abs(t), 7) <= 1e-3
    assert stats.binom.cdf(found, tries, 0.985) > 1e-9


def test_a_cell_of_independent_realisations_spends_its_shares_of_alpha_once():
    rng, alpha, tries = np.random.default_rng(), 0.01, 250
    one, exact = cell(), Reference(np.asarray(1.0), np.asarray(0.0), "", "")
    judged = [judge(one, levels(INDEPENDENT["normal"], rng, COUNTS[:1], 8), exact, alpha) for _ in range(tries)]
    shares = [sum(f.alpha for f in j.findings if f.alpha) for j in judged]
    assert max(shares) <= judgement.tests_of(one) * alpha * (1 + 1e-9)
    wrong = sum("rejected" in (f.outcome for f in j.findings) for j in judged)
    assert binomial_at_least(wrong, tries, judgement.tests_of(one) * alpha) > 1e-9, wrong
