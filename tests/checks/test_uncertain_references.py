"""References with large errors: a right subject whose reference is off by .9 of its error passes, one off by 3 of it does not.

And what is stated with it (a resolution, an interval) counts the error too.
"""

import numpy as np
import pytest
from scipy import stats

from fogproof import (
    Draws,
    Interval,
    InvalidValueError,
    Reference,
    check_convergence,
    check_estimator,
    check_sampler,
    compare_estimators,
)
from fogproof.checks.statistics.bets import Bets
from fogproof.checks.statistics.extremes import extremes_p
from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.moments import Moments

N = 40_000


def uniform(rng, n):
    return rng.random(n)


def hits(rng, n):
    return (rng.random(n) < 0.5).astype(float)


def reported(rng, n):
    x = rng.random((n, 32))
    return Draws(x.mean(axis=1), stderr=x.std(axis=1, ddof=1) / np.sqrt(32))


def costly(rng, n):
    return Draws(rng.random(n), cost=rng.integers(1, 4, n).astype(float))


def ordered(rng, n):
    order = rng.integers(1, 3, n)
    return Draws(rng.random(n), order=order)


def about(value, off):
    """A reference that is off by so many of its error."""
    return Reference(value * (1 + 0.05 * off), 0.05 * value)


KINDS = {
    "mean": (uniform, lambda off: about(0.5, off), {}),
    "hits": (hits, lambda off: about(0.5, off), {}),
    "channels": (lambda rng, n: rng.random((n, 2)), lambda off: Reference([0.5, 0.5 * (1 + 0.05 * off)], [0.0, 0.025]), {}),
    "declared bounds": (uniform, lambda off: about(0.5, off), {"bounds": (0.0, 1.0)}),
    "variance": (uniform, lambda off: about(0.5, 0.0), None),
    "variance about an uncertain mean": (
        uniform, lambda off: Reference(0.5 + 0.1 * np.clip(off, -0.9, 0.9), 0.1), {"variance": 1 / 12, "bounds": (0, 1)}),
    "cost": (costly, lambda off: 0.5, None),
    "orders": (ordered, lambda off: {1: about(0.25, off), 2: about(0.25, -off)}, {}),
    "light tails": (uniform, lambda off: about(0.5, off), {"tails": "light", "samples": 4000}),
    "tolerance": (uniform, lambda off: 0.5 * (1 + 0.05 * off), {"tolerance": 0.06}),
    "absolute tolerance": (uniform, lambda off: 0.5 * (1 + 0.05 * off), {"tolerance": (0.0, 0.03)}),
    "constant": (lambda rng, n: np.full(n, 0.5), lambda off: about(0.5, off), {"variance": 0}),
}  # fmt: skip


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("side", [1, -1])
def test_of_estimators(name, side):
    draw, reference, options = KINDS[name]
    for off, outcomes in ((0.9 * side, {"not rejected"}), (3.0 * side, {"rejected"})):
        more = options
        if name == "variance":
            more = {"variance": about(1 / 12, off), "tails": "light"}
        elif name == "cost":
            more = {"cost": about(2.0, off)}
        verdict = check_estimator(draw, reference(off), **{"samples": N, "alpha": 1e-9, **more})
        if "about an" in name:
            outcomes = {"not rejected"}
        assert verdict.outcome in outcomes, (off, str(verdict))


def test_bets_on_rare_bright_values_know_the_error():
    def rare(rng, n):
        return 50 * (rng.random(n) < 2e-3) * rng.random(n)

    right = check_estimator(rare, Reference(0.02, 0.031), nonnegative=True, samples=N, alpha=1e-6)
    assert right.outcome != "rejected", str(right)
    assert check_estimator(rare, Reference(0.005, 0.005), nonnegative=True, samples=N).outcome == "rejected"


@pytest.mark.parametrize("off", [0.9, -0.9])
def test_standard_errors_are_held_to_what_the_reference_is_known_to(off):
    """Their squares and their coverage; a right estimator would be rejected for an error of its reference."""
    error = 1 / np.sqrt(12 * 32)
    verdict = check_estimator(reported, Reference(0.5 + off * error, error), samples=N, alpha=1e-6)
    outcomes = {f.check: f.outcome for f in verdict.findings}
    assert outcomes["coverage of standard errors"] == "not rejected", str(verdict)
    assert outcomes["square of the error less that of the standard error"] == "inconclusive", str(verdict)
    assert "rejected" not in outcomes.values()
    wrong = check_estimator(reported, Reference(0.5 + 3 * np.sign(off) * error, error), samples=N, alpha=1e-9)
    assert wrong.outcome == "rejected", str(wrong)


def test_what_is_stated_counts_the_error():
    sure, unsure = (check_estimator(uniform, Reference(0.5, error), samples=N) for error in (0.0, 0.01))
    a, b = (next(f for f in v.findings if f.check == "mean").resolution.value for v in (sure, unsure))
    assert b == pytest.approx(a + 0.01, rel=0.05)
    coarse = check_estimator(lambda rng, n: 1e-3 * rng.random(n), Reference(5e-4, 2e-3), samples=N)
    assert coarse.outcome == "inconclusive", "what cannot be told from nothing is no pass"


@pytest.mark.parametrize("off", [0.9, -0.9, 3.0, -3.0])
def test_of_convergence(off):
    verdict = check_convergence(
        lambda rng, n: rng.random(n).mean(), [300, 3000], reference=about(0.5, off), replicates=64
    )
    assert verdict.outcome == ("not rejected" if abs(off) < 1 else "rejected"), str(verdict)


@pytest.mark.parametrize("off", [0.9, -0.9, 3.0, -3.0])
def test_of_a_density(off):
    def claimed(x):
        return Reference(np.full(len(x), 1 + 1e-3 * off), np.full(len(x), 1e-3))

    verdict = check_sampler(
        lambda u: u[:, 0], lambda x: np.ones(len(x)), Interval(0.0, 1.0), dimensions=1, reference=claimed, samples=5000
    )
    assert verdict.outcome == ("not rejected" if abs(off) < 1 else "rejected"), str(verdict)


def test_of_differences():
    def other(rng, n):
        return rng.normal(0.045, 1.0, n)

    def one(rng, n):
        return rng.normal(0.0, 1.0, n)

    assert compare_estimators(one, other, tolerance=0.05, samples=N).outcome == "not rejected"
    assert (
        compare_estimators(one, lambda rng, n: rng.normal(0.15, 1, n), tolerance=0.05, samples=N).outcome == "rejected"
    )
    wide = compare_estimators(one, lambda rng, n: rng.normal(0, 3, n), variance=(1.0, 9.0), samples=N)
    assert wide.outcome != "rejected", str(wide)
    short = compare_estimators(one, lambda rng, n: rng.normal(0, 3, n), variance=(9.0, 9.0), samples=N)
    assert short.outcome != "not rejected", "the differences vary by less than declared"


def test_facts_that_hold_for_every_law_know_the_error_too():
    """All laws of two values whose mean lies at an end of the claim: p-values are no smaller than they may be."""
    low, high = 0.3, 0.5
    for share, known in (
        (high, Known(low=0.0, high=1.0)),
        (low, Known(low=0.0, high=1.0)),
        (high, Known(variance=0.25)),
    ):
        n = 14
        found = []
        for k in range(n + 1):
            x = (np.arange(n) < k).astype(float)
            chance = stats.binom.pmf(k, n, share)
            for name, p in (
                ("extremes", extremes_p(Moments.of(x), low, high, known)),
                ("bets", Bets(low, high, known, n, 1e-3).after(x).p_value),
            ):
                found.append((name, p, chance))
        for name in ("extremes", "bets"):
            mine = [(p, chance) for each, p, chance in found if each == name]
            for t, _ in mine:
                assert sum(chance for p, chance in mine if p <= t) <= t * (1 + 1e-9), (name, share, t)


def test_a_share_of_nothing_is_no_tolerance():
    def draw(rng, n):
        return rng.standard_normal(n)

    with pytest.raises(InvalidValueError, match="absolute part where the reference is 0"):
        check_estimator(draw, 0.0, tolerance=0.01)
    assert check_estimator(draw, 0.0, tolerance=(0.01, 0.01), samples=N, alpha=1e-7).outcome == "not rejected"


@pytest.mark.parametrize("spread", [0.0, 1e-3])
def test_what_is_tolerated_of_a_mean_leaves_no_doubt_of_its_spread(spread):
    def draw(rng, n):
        return Draws(rng.normal(1.005, spread, n), stderr=np.full(n, spread))

    options = {"samples": N, "alpha": 1e-7} | ({"variance": spread**2} if spread else {})
    tolerated = check_estimator(draw, 1.0, tolerance=0.01, **options)
    assert tolerated.outcome == "not rejected", tolerated
    unsure = check_estimator(draw, Reference(1.0, 0.01), **options)
    assert unsure.outcome == "inconclusive", unsure
    assert "known too coarsely" in str(unsure)
