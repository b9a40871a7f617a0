"""p-values of means against SciPy and against enumeration of every outcome: never smaller than the truth, and not much larger."""

import math

import numpy as np
import pytest
from scipy import stats

from fogproof.checks.statistics.bets import Bets
from fogproof.checks.statistics.extremes import detectable, extremes_p
from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.light import light_tailed_p
from fogproof.checks.statistics.means import mean_test
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.power import binomial_reach


@pytest.mark.parametrize("n", [2000, 20_000])
def test_students_p_value_is_scipys(n):
    rng = np.random.default_rng()
    for shift in (0.0, 2.0, 5.0):
        x = rng.normal(shift / np.sqrt(n), 1, n)
        found = mean_test("mean", "mean", Moments.of(x), 0.0, 0.0, 1e-6).p_value
        expected = stats.ttest_1samp(x, 0.0).pvalue
        skew = abs(stats.skew(x)) * abs(stats.ttest_1samp(x, 0.0).statistic) ** 3 / (3 * np.sqrt(n))
        assert found == pytest.approx(min(1.0, expected * np.exp(skew)), rel=1e-6)


@pytest.mark.parametrize(
    ("hits", "n", "p"), [(0, 40, 0.1), (3, 40, 0.1), (17, 40, 0.1), (39, 40, 0.5), (500, 10_000, 0.04)]
)
def test_hits_have_the_binomial_law(hits, n, p):
    x = np.where(np.arange(n) < hits, 2.0, 0.0)
    found = mean_test("mean", "mean", Moments.of(x), 2 * p, 0.0, 1e-6)
    tail = min(1.0, 2 * min(stats.binom.cdf(hits, n, p), stats.binom.sf(hits - 1, n, p)))
    if 1 < hits < n - 1:
        assert found.p_value == pytest.approx(tail, rel=1e-9)
    else:
        assert found.p_value is None or found.p_value >= tail


def power(n, low, alpha, p):
    """Probability that the exact binomial test rejects, hit by hit."""
    k = np.arange(n + 1)
    tails = np.minimum(1.0, 2 * np.minimum(stats.binom.cdf(k, n, low), stats.binom.sf(k - 1, n, low)))
    return stats.binom.pmf(k, n, p)[tails <= alpha].sum()


@pytest.mark.parametrize(("n", "p"), [(100, 0.5), (1000, 0.02), (1000, 0.9), (30, 0.3)])
def test_resolution_of_hits_is_their_exact_power(n, p):
    reach = binomial_reach(n, p, p, 1e-6)
    for side in (p + reach, p - reach):
        if 0 < side < 1:
            assert power(n, p, 1e-6, side) >= 0.99 * (1 - 1e-6)
    sides = [side for side in (p + 0.97 * reach, p - 0.97 * reach) if 0 < side < 1]
    assert min(power(n, p, 1e-6, side) for side in sides) < 0.99  # and it is tight


@pytest.mark.parametrize("share", [0.02, 0.3, 0.5, 0.98])
@pytest.mark.parametrize("known", [Known(low=0.0, high=1.0), Known(low=0.0, high=3.0), "variance", Known(low=0.0)])
def test_whatever_the_law_p_values_hold_by_enumeration(share, known):
    """All outcomes of 12 realisations of two values: P(p <= t) <= t for every t, for declared facts that are true."""
    known = Known(variance=share * (1 - share)) if known == "variance" else known
    n, total = 12, {}
    for hits in range(n + 1):
        x = np.where(np.arange(n) < hits, 1.0, 0.0)
        chance = math.comb(n, hits) * share**hits * (1 - share) ** (n - hits)
        by_extremes = extremes_p(Moments.of(x), share, share, known)
        by_bets = Bets(share, share, known, n, 1e-3).after(x).p_value
        for name, p in (("extremes", by_extremes), ("bets", by_bets)):
            total.setdefault(name, []).append((p, chance))
    for name, pairs in total.items():
        for t, _ in pairs:
            assert sum(chance for p, chance in pairs if p <= t) <= t * (1 + 1e-9), (name, t)


def test_black_pixels_have_the_closed_forms():
    dark = Moments.of(np.zeros(50))
    assert extremes_p(dark, 0.3, 0.3, Known(low=0.0, high=1.0)) == pytest.approx(2 * 2 * 0.7**50, rel=1e-9)
    assert extremes_p(dark, 0.3, 0.3, Known(variance=0.1)) == pytest.approx(2 * (0.1 / 0.19) ** 50, rel=1e-9)
    bright = Moments.of(np.full(50, 0.6))
    assert extremes_p(bright, 0.3, 0.3, Known(low=0.0)) == pytest.approx(2 * 0.5**50, rel=1e-9)
    assert extremes_p(bright, 0.3, 0.3, Known()) == 1.0


def test_bounds_and_a_variance_together_pay_for_each_of_their_inequalities():
    """Hoeffding's with Kullback and Leibler's divergence, Bennett's, the extremes: two sides each, the smallest of all decides."""
    n, hits, m = 50, 30, 0.3
    x = Moments.of(np.where(np.arange(n) < hits, 1.0, 0.0))
    hoeffding = (m / 0.6) ** hits * ((1 - m) / 0.4) ** (n - hits)
    bennett = (math.e / 4) ** (n * 0.21 / 0.7**2)  # u = 0.7 x 0.3 / 0.21 = 1, h(1) = 2 log 2 - 1
    assert extremes_p(x, m, m, Known(low=0.0, high=1.0)) == pytest.approx(4 * hoeffding, rel=1e-9)
    both = extremes_p(x, m, m, Known(variance=0.21, low=0.0, high=1.0))
    assert both == pytest.approx(8 * min(hoeffding, bennett), rel=1e-9)
    rare = Moments.of(np.where(np.arange(1000) < 30, 1.0, 0.0))  # here Bennett's is the smaller one
    u = 0.99 * 0.02 / 1e-3
    bennett = math.exp(-1000 * 1e-3 / 0.99**2 * ((1 + u) * math.log(1 + u) - u))
    assert extremes_p(rare, 0.01, 0.01, Known(variance=1e-3, low=0.0, high=1.0)) == pytest.approx(8 * bennett, rel=1e-9)


def test_a_claim_known_to_within_an_error_is_not_bet_against_inside_it():
    """The mean lies at either end of the claim, 50 standard errors from its middle."""
    n, rng = 10_000, np.random.default_rng()
    for end in (-0.5, 0.5):
        x = rng.normal(end, 1, n)
        assert Bets(-0.5, 0.5, Known(variance=1.0), n, 1e-3).after(x).p_value > 1e-3
        assert Bets(-0.5, 0.5, Known(variance=1.0), n, 1e-3).after(x + 0.2 * np.sign(end)).p_value < 1e-6


def test_bounds_resolve_what_they_say():
    known, n, rng = Known(low=0.0, high=1.0), 2000, np.random.default_rng()
    reach = detectable(n, known, 1e-4, 0.01)
    found = [extremes_p(Moments.of((rng.random(n) < 0.4 + reach) * 1.0), 0.4, 0.4, known) <= 1e-4 for _ in range(200)]
    assert sum(found) >= 190


@pytest.mark.parametrize("n", [5, 12, 30, 200])
@pytest.mark.parametrize("law", ["exponential", "reflected", "normal", "uniform", "laplace"])
def test_light_tails_keep_their_promise_at_any_number(n, law):
    """At 1e-2, where Student's test alone is wrong by a factor of ten for few exponential numbers."""
    rng = np.random.default_rng()
    draw = {
        "exponential": lambda size: rng.exponential(size=size) - 1,
        "reflected": lambda size: 1 - rng.exponential(size=size),
        "normal": lambda size: rng.normal(size=size),
        "uniform": lambda size: rng.random(size) - 0.5,
        "laplace": lambda size: rng.laplace(size=size),
    }[law]
    x = draw((4000, n))
    z = np.abs(x.mean(axis=1)) / (x.std(axis=1, ddof=1) / np.sqrt(n))
    critical = next(z for z in np.geomspace(1, 1e4, 400) if light_tailed_p(n, z) <= 0.01)
    small = int(np.count_nonzero(z >= critical))
    assert stats.binom.sf(small - 1, 4000, 0.01) > 1e-9, f"{small} of 4000"


def test_moments_of_extreme_numbers_are_those_of_ordinary_ones():
    rng = np.random.default_rng()
    x = rng.gamma(0.7, size=1000)
    whole = Moments.of(x)
    for k in (-1000, -500, 500, 1000):
        parts = [Moments.of(np.ldexp(part, k)) for part in np.array_split(x, [1, 400])]
        merged = parts[0].merged(parts[1]).merged(parts[2])
        assert merged.mean == pytest.approx(math.ldexp(whole.mean, k), rel=1e-12)
        assert merged.stderr == pytest.approx(math.ldexp(whole.stderr, k), rel=1e-9)
        assert merged.skewness == pytest.approx(whole.skewness, rel=1e-9)
        assert merged.largest_share == pytest.approx(whole.largest_share, rel=1e-9)
    mixed = Moments.of(np.array([1e-200, 3e-200])).merged(Moments.of(np.array([1e200, 3e200])))
    assert mixed.deviation == pytest.approx(np.std(np.array([0, 0, 1, 3.0]), ddof=1) * 1e200, rel=1e-9)
    state = mixed.to_dict()
    assert Moments.from_dict(state).to_dict() == state
