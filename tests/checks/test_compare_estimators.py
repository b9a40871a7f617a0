"""What two estimators of hits, of constants, and of several channels are told."""

import numpy as np
import pytest
from scipy.stats import binom

from fogproof import Draws, check_estimator, compare_estimators
from fogproof.checks.statistics.binomial import binomial_p
from fogproof.checks.statistics.power import sign_reach


def power(n, unlike, difference, alpha):
    """Return the probability that the sign test rejects, if a share of the pairs is unlike and their hits differ so much."""
    found, share = 0.0, 0.5 + 0.5 * difference / unlike
    for count in range(int(binom.isf(1e-12, n, unlike)) + 1):
        critical = next((k for k in range(count // 2, count + 1) if binomial_p(k, count, 0.5, 0.5) <= alpha), None)
        if critical is not None:
            found += binom.pmf(count, n, unlike) * binom.sf(critical - 1, count, share)
    return found


@pytest.mark.parametrize(("n", "alpha"), [(20_000, 1e-6), (300, 1e-3)])
@pytest.mark.parametrize("hits", [0, 2, 40, 120])
def test_the_resolution_of_hits_is_kept(n, alpha, hits):
    """Whatever share of unlike pairs goes with so many seen: a difference as stated is found, one of a third of it hardly."""
    stated = sign_reach(n, hits, alpha)
    for unlike in {max(stated, factor * hits / n) for factor in (0.5, 1.0, 1.2)}:
        assert power(n, unlike, stated, alpha) >= 0.99
    assert power(n, max(stated, hits / n), stated / 3, alpha) < 0.2


def test_few_pairs_resolve_nothing():
    assert sign_reach(10, 3, 1e-6) == 1.0


def test_rare_hits_against_none_are_not_passed_above_the_resolution():
    for probability in (3e-4, 1e-3, 2e-3):
        verdict = compare_estimators(
            lambda rng, n, p=probability: 3.0 * (rng.random(n) < p), lambda rng, n: np.zeros(n), samples=20_000
        )
        assert verdict.outcome != "not rejected" or verdict.resolution.value > 3 * probability


def constant(value):
    return lambda rng, n: np.full(n, value)


def test_equal_constants_are_equal():
    assert compare_estimators(constant(0.3), constant(0.1 + 0.2), samples=1000).outcome == "not rejected"
    single = constant(np.float32(0.1))
    assert compare_estimators(single, constant(0.1), samples=1000, precision="float32").outcome == "not rejected"
    assert compare_estimators(constant(0.3), constant(0.3 + 1e-9), samples=1000).outcome == "inconclusive"


def test_what_is_not_finite_is_called_so():
    verdict = compare_estimators(lambda rng, n: rng.random(n), constant(np.nan), samples=1000)
    assert (verdict.outcome, verdict.cause) == ("rejected", "not a number")


@pytest.mark.parametrize("stated", [0.3, 0.1])
def test_one_standard_error_may_stand_for_all_channels(stated):
    def draw(rng, n):
        return Draws(rng.normal(0.0, 0.3, (n, 2)), stderr=np.full(n, stated))

    verdict = check_estimator(draw, [0.0, 0.0], samples=200_000, alpha=1e-6)
    assert verdict.outcome == ("not rejected" if stated == 0.3 else "rejected")


def test_the_same_check_gives_the_same_verdict():
    first, second = (check_estimator(lambda rng, n: rng.random(n), 0.5, samples=1000, seed=3) for _ in range(2))
    assert first == second
