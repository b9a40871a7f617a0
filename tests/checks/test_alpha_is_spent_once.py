"""The shares of alpha that the findings of a verdict have add up to alpha at most, and to most of it where nothing is kept back."""

import numpy as np
import pytest

from fogproof import (
    Discrete,
    Draw,
    Draws,
    HalfLine,
    Interval,
    Product,
    Run,
    UnitSphere,
    check_convergence,
    check_estimator,
    check_family,
    check_sampler,
    check_streams,
    compare_estimators,
)
from fogproof.checks import Finding, Verdict, family_search
from fogproof.checks.judgement import share_of_means

ALPHA = 1e-4


def spent(verdict):
    return sum(f.alpha for f in verdict.findings if f.alpha is not None)


def exponential(u):
    return -np.log1p(-u[:, 0])


def flat_sphere(u):
    sine, phi = 2 * np.sqrt(u[:, 0] * (1 - u[:, 0])), 2 * np.pi * u[:, 1]
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), 1 - 2 * u[:, 0]], axis=-1)


def stopped(u):
    """A free path that ends at 1 with probability 1/e, with labels and weights of two channels."""
    t = np.minimum(exponential(u), 1.0)
    return Draw(t, weight=np.full((len(t), 2), [0.5, 0.25]), event=(t == 1.0).astype(float))


SAMPLERS = {
    "line": (exponential, lambda t: np.exp(-t), HalfLine(0.0), {"dimensions": 1}),
    "line with a cdf": (exponential, lambda t: np.exp(-t), HalfLine(0.0), {"dimensions": 1, "cdf": lambda t: -np.expm1(-t)}),
    "sphere": (flat_sphere, lambda x: np.full(len(x), 0.25 / np.pi), UnitSphere(), {"dimensions": 2}),
    "its own uniforms": (lambda rng, n: rng.exponential(size=n), lambda t: np.exp(-t), HalfLine(0.0), {"dimensions": None}),
    "table": (lambda u: np.floor(4 * u[:, 0]), lambda i: np.full(len(i), 0.25), Discrete(4), {"dimensions": 1}),
    "labels alone": (
        lambda u: u,
        lambda x: np.ones(len(x)),
        Product(Interval(0.0, 1.0), Interval(0.0, 1.0), Interval(0.0, 1.0)),
        {"dimensions": 3},
    ),
    "atom, events, weights": (
        stopped,
        lambda t: np.exp(-t),
        Interval(0.0, 1.0),
        {
            "dimensions": 1,
            "atoms": {1.0: np.exp(-1)},
            "events": {0: 1 - np.exp(-1), 1: np.exp(-1)},
            "albedo": (0.5, 0.25),
        },
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SAMPLERS)
def test_of_a_sampler(name):
    sample, pdf, domain, options = SAMPLERS[name]
    verdict = check_sampler(sample, pdf, domain, samples=20_000, alpha=ALPHA, **options)
    assert verdict.outcome == "not rejected", str(verdict)
    assert spent(verdict) == pytest.approx(ALPHA, rel=1e-9)
    assert all(f.alpha < 0.5 * ALPHA for f in verdict.findings if f.alpha), "no test has it all"


def gamma(rng, n):
    return rng.gamma(2.0, 0.5, n)


def reported(rng, n):
    x = rng.gamma(2.0, 0.5, (n, 16))
    return Draws(x.mean(axis=1), stderr=x.std(axis=1, ddof=1) / 4)


def ordered(rng, n):
    order = rng.integers(1, 4, n)
    return Draws(order * rng.random(n), order=order, cost=order.astype(float))


ESTIMATORS = {
    "mean": (gamma, 1.0, {}),
    "channels": (lambda rng, n: rng.random((n, 5)), np.full(5, 0.5), {}),
    "variance": (lambda rng, n: rng.random(n), 0.5, {"variance": 1 / 12, "bounds": (0, 1)}),
    "standard errors": (reported, 1.0, {}),
    "orders and cost": (ordered, {1: 1 / 6, 2: 1 / 3, 3: 1 / 2}, {"cost": 2.0}),
    "growing": (gamma, 1.0, {"resolution": 0.5}),
}


@pytest.mark.parametrize("name", ESTIMATORS)
def test_of_an_estimator(name):
    draw, reference, options = ESTIMATORS[name]
    verdict = check_estimator(draw, reference, samples=20_000, alpha=ALPHA, **options)
    looks = len(verdict.settings["looks"]) if "resolution" in options else 1
    assert verdict.outcome == "not rejected", str(verdict)
    assert 0.4 * ALPHA / looks < spent(verdict) <= ALPHA / looks * (1 + 1e-9)
    means = [f for f in verdict.findings if f.check.startswith("mean")]
    assert sum(f.alpha for f in means) > 0.15 * ALPHA / looks
    assert sum(f.alpha for f in verdict.findings if f.alpha and f not in means) < 0.95 * ALPHA / looks


def test_the_three_ways_to_judge_a_mean_have_the_shares_that_are_planned_with():
    """The usual test, declared facts and bets decide one case each: their parts are those of `share_of_means`."""
    usual, facts, bets = share_of_means(ALPHA, 1, True)
    whole = share_of_means(ALPHA, 1, False)
    assert usual + facts + bets <= 0.95 * ALPHA * (1 + 1e-12)
    assert whole[0] + whole[2] <= 0.95 * ALPHA * (1 + 1e-12)

    def mean_of(draw, reference, **options):
        verdict = check_estimator(draw, reference, alpha=ALPHA, **options)
        return next(f for f in verdict.findings if f.check == "mean")

    assert mean_of(gamma, 1.0, samples=5000).alpha == pytest.approx(whole[0], rel=1e-12)
    assert mean_of(gamma, 1.0, samples=5000, bounds=(0, 100)).alpha == pytest.approx(usual, rel=1e-12)
    dark = mean_of(lambda rng, n: np.zeros(n), 0.3, samples=5000, bounds=(0, 1))
    assert (dark.outcome, dark.alpha) == ("rejected", pytest.approx(facts, rel=1e-12))
    rare = mean_of(lambda rng, n: 50 * (rng.random(n) < 2e-3) * rng.random(n), 0.001, samples=20_000, nonnegative=True)
    assert (rare.outcome, rare.alpha) == ("rejected", pytest.approx(bets, rel=1e-12))


@pytest.mark.parametrize("first", [gamma, reported, lambda rng, n: rng.random((n, 4)) < 0.5])
def test_of_a_comparison(first):
    verdict = compare_estimators(first, first, samples=20_000, alpha=ALPHA)
    assert verdict.outcome == "not rejected", str(verdict)
    assert 0.4 * ALPHA < spent(verdict) <= ALPHA * (1 + 1e-9)


@pytest.mark.parametrize("options", [{"reference": [0.5, 0.5]}, {}])
def test_of_convergence(options):
    verdict = check_convergence(lambda rng, n: rng.random((n, 2)).mean(axis=0), [10, 100, 1000], alpha=ALPHA, **options)
    assert spent(verdict) == pytest.approx(ALPHA, rel=1e-9)


def test_of_streams():
    verdict = check_streams(lambda i: np.random.default_rng([5, i]), 64, alpha=ALPHA)
    assert spent(verdict) == pytest.approx(ALPHA, rel=1e-9)


class _Member:
    reference = 0.0

    def __init__(self, parameter):
        self.parameter = parameter

    def draw(self, rng, n):
        raise AssertionError("nothing is drawn here")


@pytest.mark.parametrize("wrong", [0, 1])
def test_of_a_family_with_all_that_shrinking_asks(monkeypatch, wrong):
    """Every check of a search, also those that make a rejected parameter simpler."""
    from hypothesis import strategies

    asked = []

    def check(draw, reference, *, samples, alpha, seed):
        asked.append(alpha)
        parameter = draw.__self__.parameter
        outcome = "rejected" if wrong and parameter > 137 else "not rejected"
        return Verdict((Finding("mean", outcome, "", 0.5, alpha),), alpha, samples, seed)

    monkeypatch.setattr(family_search, "check_estimator", check)
    verdict = check_family(_Member, strategies.integers(0, 10**6), members=32, samples=10**5, alpha=ALPHA, seed=3)
    assert verdict.outcome == ("rejected" if wrong else "not rejected")
    assert 0 < sum(asked) <= ALPHA * (1 + 1e-9)
    asked.clear()
    check_family(_Member, list(range(100 + 100 * wrong)), samples=10**5, alpha=ALPHA, seed=3)
    assert 0 < sum(asked) <= ALPHA * (1 + 1e-9)


def test_of_a_run_of_ones_own():
    asked = []

    def check(alpha):
        asked.append(alpha)
        return Verdict((), alpha, 1, 1)

    run = Run(alpha=ALPHA, seed=1)
    for i in range(500):
        run.check(f"case {i}", check)
    assert 0.99 * ALPHA < sum(asked) <= ALPHA
