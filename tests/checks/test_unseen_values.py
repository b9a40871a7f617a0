"""Values that were seen are no law: others, too rare to be met, may hold what a mean lacks, if nothing declared forbids it."""

import numpy as np
import pytest

from fogproof import Draws, check_convergence, check_estimator
from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.means import mean_test
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.two_values import _shares_of, two_values_test

ALPHA = 1e-6


def hits(probability):
    return lambda rng, n: (rng.random(n) < probability).mean()


def edge(rng, n):
    """One sample in each of n strata, and the edge runs through one of them."""
    return ((np.arange(n) + rng.random(n)) / n < 0.3).mean()


def wobbling(rng, n):
    return 0.5 + 1e-3 * (rng.random() < 0.03)


RIGHT = {
    "rare hits": (hits(0.002), [4, 16, 64, 256], 0.002),
    "hits": (hits(0.1), [1, 4, 16, 64], 0.1),
    "strata": (edge, [16, 64, 256, 1024], 0.3),
    "hardly ever": (wobbling, [16, 64, 256], 0.50003),
}


@pytest.mark.parametrize("referenced", [True, False])
@pytest.mark.parametrize("name", RIGHT)
def test_estimates_that_happen_to_be_equal_are_no_proof(name, referenced):
    run, counts, value = RIGHT[name]
    for seed in range(20):
        verdict = check_convergence(run, counts, reference=value if referenced else None, seed=seed)
        assert verdict.outcome != "rejected", str(verdict)
        assert "declared" not in str(verdict), "nobody declared anything"


@pytest.mark.parametrize("options", [{}, {"reference": 0.5}])
def test_estimates_that_are_equal_where_others_scatter_far_less_than_they_are_off(options):
    verdict = check_convergence(lambda rng, n: rng.random(n).mean() if n < 1000 else 0.0, [100, 500, 5000], **options)
    assert verdict.outcome == "rejected", str(verdict)


def test_a_program_whose_seed_is_fixed_is_told_so():
    """Its errors go up and down by chance, of which alpha knows nothing."""
    for fixed in range(20):
        verdict = check_convergence(
            lambda rng, n, fixed=fixed: np.random.default_rng(fixed).random(n).mean(),
            [16, 64, 256, 1024, 4096],
            reference=0.5,
        )
        assert verdict.outcome != "rejected", str(verdict)
        assert "disregards its generator" in str(verdict)


def rare(rng, n):
    u = rng.random(n)
    return np.where(u < 1e-5, 1000.0, np.where(u < 0.01, 1.0, 0.0))


@pytest.mark.parametrize("bounds", [None, (0, 1000)])
def test_a_variance_that_two_values_do_not_have_says_that_there_are_others(bounds):
    for seed in range(12):
        verdict = check_estimator(rare, 0.01999, variance=10.0095903999, bounds=bounds, samples=30_000, seed=seed)
        assert verdict.outcome != "rejected", str(verdict)


def test_the_share_of_the_upper_value_is_bounded_by_the_variance():
    """Of three values, the third as rare as may be: the conditional share lies inside, and at the end where Schwarz is attained."""
    rng = np.random.default_rng()
    nearest = 1.0
    for _ in range(300):
        q, r, third = rng.uniform(0.001, 0.3), rng.random(), rng.normal(0.0, 20.0)
        values, weights = np.array([0.0, 1.0, third]), np.array([(1 - q) * (1 - r), (1 - q) * r, q])
        mean = weights @ values
        low, high = _shares_of(mean, q, Known(variance=weights @ (values - mean) ** 2), 1.0)
        assert low - 1e-9 <= r <= high + 1e-9
        nearest = min(nearest, abs(r - low), abs(r - high))
    assert nearest < 1e-9, "a single third value attains it"


def two(hits_seen, n):
    return Moments.of((np.arange(n) < hits_seen).astype(float))


def test_a_third_value_no_further_off_than_the_two_is_allowed_for():
    """1 and -1, each once in ten thousand, average to 0; the sample may have met one of them alone."""
    assert mean_test("", "", two(10, 20_000), 0.0, 0.0, ALPHA).outcome == "inconclusive"
    assert mean_test("", "", two(60, 20_000), 0.0, 0.0, ALPHA).outcome == "rejected"
    assert mean_test("", "", two(10, 20_000), 0.0, 0.0, ALPHA, known=Known(low=0.0, high=1.0)).outcome == "rejected"
    assert mean_test("", "", two(30, 20_000), 1e-4, 0.0, ALPHA).outcome == "rejected", "hits are not negative"
    assert two_values_test("", "", two(60, 20_000), 0.0, 0.0, ALPHA, Known(), further=10.0).outcome == "inconclusive"


def test_the_exact_variance_of_two_values_leaves_the_test_its_power():
    n, p = 20_000, 0.3
    free, exact = (
        mean_test("", "", two(int(p * n), n), p, 0.0, ALPHA, known=known)
        for known in (Known(), Known(variance=p * (1 - p)))
    )
    assert exact.resolution.value < 1.1 * free.resolution.value


def test_what_is_found_of_a_coin_must_leave_both_of_its_sides():
    """One that shows the same side always, or all but once, is inconclusive: only bounds decide about it."""
    bare, bounded = (
        mean_test("", "", two(25, 50), 0.5, 0.0, ALPHA, known=known) for known in (Known(), Known(low=0.0, high=1.0))
    )
    assert bare.resolution.value == 0.5
    assert bounded.resolution.value < 0.48


def averages(law, k):
    """Means of k values, with their textbook standard errors."""

    def draw(rng, n):
        x = law(rng, (n, k))
        return Draws(x.mean(axis=1), stderr=x.std(axis=1, ddof=1) / np.sqrt(k))

    return draw


@pytest.mark.parametrize("bounds", [None, (0, 1)])
@pytest.mark.parametrize(("probability", "k", "n"), [(5e-4, 4, 100_000), (0.002, 4, 10_000), (0.01, 2, 3000)])
def test_standard_errors_of_rare_hits(probability, k, n, bounds):
    """Two hits in one average are four times one in the square, and may not have been met."""
    for seed in range(5):
        draw = averages(lambda rng, shape: (rng.random(shape) < probability) * 1.0, k)
        verdict = check_estimator(draw, probability, bounds=bounds, samples=n, seed=seed)
        assert verdict.outcome != "rejected", str(verdict)


@pytest.mark.parametrize("bounds", [None, (0, 1)])
def test_wrong_standard_errors_of_two_values_are_found(bounds):
    def coin(rng, n):
        return Draws((rng.random(n) < 0.3) * 1.0, stderr=np.full(n, 0.5))

    verdict = check_estimator(coin, 0.3, bounds=bounds, samples=100_000)
    assert "square of the error" in next(f.check for f in verdict.findings if f.outcome == "rejected"), str(verdict)


LAWS = {
    "uniform": (lambda rng, shape: rng.random(shape), 0.5),
    "coin": (lambda rng, shape: (rng.random(shape) < 0.5) * 1.0, 0.5),
    "rarer": (lambda rng, shape: (rng.random(shape) < 0.2) * 1.0, 0.2),
    "exponential": (lambda rng, shape: rng.exponential(size=shape), 1.0),
}


@pytest.mark.parametrize("k", [2, 3, 4, 7])
@pytest.mark.parametrize("name", LAWS)
def test_standard_errors_of_few_values_have_the_coverage_of_their_law(name, k):
    law, mean = LAWS[name]
    verdict = check_estimator(averages(law, k), mean, samples=30_000)
    assert verdict.outcome != "rejected", str(verdict)
    said = next(f.message for f in verdict.findings if f.check.startswith("coverage"))
    if k < 7 and name != "exponential":  # elsewhere kurtosis hides how many they are
        assert "of so few values their law decides" in said
