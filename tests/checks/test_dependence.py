"""Realisations that depend on each other are found in any channel and order, at any distance; independent ones are left alone."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from fogproof import check_estimator, compare_estimators
from fogproof.checks.statistics.dependence import concordance, evenness_of_calls
from fogproof.checks.statistics.succession import Succession, _counted


def lagged(lag):
    def draw(rng, n):
        x = rng.normal(size=n + lag)
        return (x[lag:] + 0.3 * x[:-lag]) / np.sqrt(1.09)

    return draw


def antithetic(rng, n):
    u = rng.random(n // 2)
    return np.concatenate([u, 1 - u, rng.random(n % 2)]) - 0.5


def shuffled_strata(rng, n):
    return rng.permutation((np.arange(n) + rng.random(n)) / n) - 0.5


def hypercube(rng, n):
    strata = [rng.permutation((np.arange(n) + rng.random(n)) / n) for _ in range(2)]
    return np.sin(7 * strata[0]) + strata[1] ** 2 - (1 - np.cos(7)) / 7 - 1 / 3


def stratified_halves(rng, n):
    return np.concatenate([shuffled_strata(rng, n // 2), shuffled_strata(rng, n - n // 2)])


def jittered(rng, n):
    side = int(np.sqrt(n))
    cells = rng.permutation(side * side)
    x = (np.stack([cells // side, cells % side], axis=-1) + rng.random((side * side, 2))) / side
    return np.concatenate([x, rng.random((n - side * side, 2))]).prod(axis=1) - 0.25


def twice(rng, n):
    x = rng.normal(size=(n + 1) // 2)
    return np.concatenate([x, x])[:n]


def twice_shuffled(rng, n):
    return rng.permutation(twice(rng, n))


def second_channel(rng, n):
    return np.stack([rng.normal(size=n), lagged(2)(rng, n)], axis=-1)


def halves_equal_up_to_sign(rng, n):
    x = rng.normal(size=n // 2)
    return np.concatenate([x, -x, rng.normal(size=n % 2)])


DEPENDENT = [
    ("two apart", lagged(2), 0.0),
    ("seventeen of one seed in a call", lambda rng, n: np.tile(rng.normal(size=n // 17 + 1), 17)[:n], 0.0),
    ("antithetic halves", antithetic, 0.0),
    ("shuffled strata", shuffled_strata, 0.0),
    ("stratified halves", stratified_halves, 0.0),
    ("strata of a half line", lambda rng, n: -np.log(0.5 - shuffled_strata(rng, n)), 1.0),
    ("strata of two values", lambda rng, n: (shuffled_strata(rng, n) < -0.2) * 1.0, 0.3),
    ("Latin hypercube", hypercube, 0.0),
    ("jittered grid", jittered, 0.0),
    ("returned twice", twice, 0.0),
    ("returned twice, shuffled", twice_shuffled, 0.0),
    ("second channel", second_channel, [0.0, 0.0]),
    ("second half the negative of the first", halves_equal_up_to_sign, 0.0),
    ("every value of the call before", lambda rng, n: np.random.default_rng(n).normal(size=n), 0.0),
]


NAMED = ("repeated samples", "stratified samples", "correlation")


@pytest.mark.parametrize(("name", "draw", "mean"), DEPENDENT, ids=[c[0] for c in DEPENDENT])
def test_dependent_realisations_are_found(name, draw, mean):
    verdict = check_estimator(draw, mean, samples=400_000)
    assert verdict.outcome == "rejected", str(verdict)
    assert verdict.cause in NAMED
    if np.ndim(mean) == 0:
        compared = compare_estimators(draw, lambda rng, n: rng.normal(size=n), samples=400_000)
        assert compared.cause in NAMED, str(compared)


INDEPENDENT = [
    ("normal", lambda rng, n: rng.normal(size=n), 0.0),
    ("hits", lambda rng, n: (rng.random(n) < 0.3) * 1.0, 0.3),
    ("rare hits", lambda rng, n: (rng.random(n) < 1e-3) * 1.0, 1e-3),
    ("lattice", lambda rng, n: rng.poisson(200, n) * 1.0, 200.0),
    ("mostly nothing", lambda rng, n: (rng.random(n) < 0.01) * rng.exponential(size=n), 0.01),
    ("skewed", lambda rng, n: rng.lognormal(0, 1, n), np.exp(0.5)),
    ("a die", lambda rng, n: rng.integers(1, 7, n) * 1.0, 3.5),
]


@pytest.mark.parametrize(("name", "draw", "mean"), INDEPENDENT, ids=[c[0] for c in INDEPENDENT])
def test_independent_realisations_are_not(name, draw, mean):
    for _ in range(3):
        verdict = check_estimator(draw, mean, samples=200_000)
        assert verdict.outcome != "rejected", str(verdict)


def test_calls_of_a_handful_of_values_are_as_uneven_as_they_are():
    """Cells that are never hit do not count: the test of evenness has its false-alarm probability for any law."""
    laws = (lambda rng: rng.random(16_000) < 0.3, lambda rng: rng.poisson(2, 16_000), lambda rng: rng.random(16_000))
    for draw in laws:
        found = 0
        for seed in range(200):
            x = draw(np.random.default_rng([seed, 7])).astype(float)[:, None]
            record = Succession.about(x)
            record = replace(record, counts=tuple(_counted(part, record.edges) for part in np.split(x, 8)))
            found += evenness_of_calls("evenness", record, 0.01).outcome == "rejected"
        assert found <= 12  # P(more | 1 %) < 1e-6


def test_pairs_of_large_values_have_the_exact_law_of_runs():
    """Of large values among n, the runs are hypergeometric (Wald & Wolfowitz 1940): no p-value is smaller than that law says."""
    rng = np.random.default_rng()
    for n, large in ((200, 100), (2000, 600), (5000, 500)):
        exact = stats.hypergeom(n, n - large + 1, large)
        x = np.where(np.arange(n) < large, 1.0, 0.0)
        for _ in range(50):
            record = Succession(np.array([0.5])).after(rng.permutation(x)[:, None], [n])
            runs = large - int(record.both[0, 0])
            tail = min(1.0, 2 * min(exact.cdf(runs), exact.sf(runs - 1)))
            p, _, _ = concordance(record, 0, 0)
            assert 0.7 * tail <= p <= max(40 * tail**0.4, 0.3)
