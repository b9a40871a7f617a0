"""p-values of each component: those of SciPy or of enumeration where there are any, else never too small, nor useless."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy import stats

from fogproof.checks.call_sizes import one_law
from fogproof.checks.convergence import _scatter
from fogproof.checks.density.grid import Marginal
from fogproof.checks.density.grid_of_map import unit_cube_grid
from fogproof.checks.density.lookup import Lookup
from fogproof.checks.generators import _correlation, _kolmogorov, _pairs
from fogproof.checks.statistics.binomial import binomial_p
from fogproof.checks.statistics.chi_square import chi_square, deviances, pooled
from fogproof.checks.statistics.coverage import SLACK, Coverage, coverage_test, degrees_of_freedom
from fogproof.checks.statistics.dependence import (
    concordance,
    repeated_stretches,
    repeats_within_calls,
    runs_test,
    spread_of_calls,
)
from fogproof.checks.statistics.extremes import extremes_p
from fogproof.checks.statistics.heavy import TailEstimate
from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.kolmogorov import kolmogorov
from fogproof.checks.statistics.light import light_tailed_p
from fogproof.checks.statistics.means import mean_test, trusted
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.scan import _extreme_p, scan, scan_ends, scan_plane
from fogproof.checks.statistics.serial import Successions, in_units, serial_test
from fogproof.checks.statistics.smooth import cross, smooth
from fogproof.checks.statistics.sparse_chi_square import chi_square_sparse
from fogproof.checks.statistics.succession import Succession
from fogproof.checks.statistics.tails import binomial_at_least
from fogproof.checks.statistics.welch import difference_test
from fogproof.checks.subject import Subject
from fogproof.domains import Interval, Product

LEVELS = (0.3, 0.1, 0.02)


def near(value, rel):
    """Of small p-values too: `pytest.approx` alone takes all that are below 1e-12 for equal."""
    return pytest.approx(value, rel=rel, abs=1e-305)


def line(cells, error=0.0, blur=0.0):
    """Cells of equal probability on [0, 1], each edge's cdf known to within `error`."""
    edges = np.linspace(0, 1, cells + 1)
    none, unsure = np.zeros(cells + 1), np.full(cells + 1, error)
    return Marginal(
        "x", edges, edges, edges, none, unsure, np.full(cells + 1, blur), True, Lookup.of(edges), lambda c: c
    )


def held(p, tight=0.0):
    """p-values of what is right are not too small at any level; nor, by more than the factor `tight`, too large."""
    p = np.array(p)
    for level in LEVELS:
        small = int(np.count_nonzero(p <= level))
        assert stats.binom.sf(small - 1, len(p), level) > 1e-9, (level, small, len(p))
        assert stats.binom.cdf(small, len(p), tight * level) > 1e-9, (level, small, len(p))


@pytest.mark.parametrize(("n", "p"), [(12, 0.3), (40, 0.5), (300, 0.01)])
def test_binomial_by_enumeration(n, p):
    hits = np.arange(n + 1)
    law = stats.binom.pmf(hits, n, p)
    found = np.array([binomial_p(int(k), n, p, p) for k in hits])
    lower, upper = np.cumsum(law), np.cumsum(law[::-1])[::-1]
    assert found == near(np.minimum(1, 2 * np.minimum(lower, upper)), rel=1e-9)
    low, high = p / 2, min(1.5 * p, 1.0)
    kind = [max(binomial_p(int(k), n, q, q) for q in np.linspace(low, high, 41)) for k in hits]
    assert [binomial_p(int(k), n, low, high) for k in hits] == near(kind, rel=1e-9)


def test_far_tails_of_few_trials_by_fractions():
    p = Fraction(1e-14)
    for count, n in ((19, 20), (18, 20), (17, 40)):
        exact = sum(math.comb(n, k) * p**k * (1 - p) ** (n - k) for k in range(count, n + 1))
        assert exact < 1e-200
        assert binomial_at_least(count, n, 1e-14) == near(float(exact), rel=1e-10)


def test_kolmogorov_is_scipys_but_for_what_lies_between_edges():
    rng = np.random.default_rng()
    for shift in (0.0, 0.02, 0.05):
        x = (rng.random(4000) * (1 - shift)) + shift
        counts = np.bincount((x * 2000).astype(int), minlength=2000)
        found = kolmogorov("", line(2000), counts, 1e-6)
        exact = stats.kstwo.sf(found.statistic, 4000)
        assert min(1.0, exact) <= found.p_value <= min(1.0, 1.2 * exact + 0.3 * (exact > 0.05))
        assert found.statistic == pytest.approx(stats.kstest(x, "uniform").statistic, abs=1 / 2000)


def test_an_error_of_the_cdf_never_rejects():
    counts = np.full(100, 100)
    counts[:50] += 10
    counts[50:] -= 10
    sure, unsure = (kolmogorov("", line(100, error), counts, 1e-3) for error in (0.0, 0.051))
    assert sure.p_value < 1e-9
    assert (unsure.p_value, unsure.outcome) == (1.0, "inconclusive")
    assert smooth("", line(100), counts, 1e-3).p_value < 1e-9
    assert smooth("", line(100, 0.051), counts, 1e-3).p_value == pytest.approx(1.0)
    assert scan("", line(100), counts, 1e-3).p_value < 1e-3
    assert scan("", line(100, 0.051), counts, 1e-3).p_value == 1.0
    counts, mass, none = 10 * counts, np.full(100, 0.01), np.zeros(100)
    assert chi_square("", counts, mass, none, none, 1e-3).p_value < 1e-9
    doubtful = chi_square("", counts, mass, np.full(100, 0.0011), none, 1e-3)
    assert (doubtful.p_value, doubtful.outcome) == (1.0, "inconclusive")
    rounded = chi_square("", counts, mass, none, np.full(100, 0.0011), 1e-3)
    assert (rounded.p_value, rounded.outcome) == (1.0, "not rejected"), "rounding is no reason to doubt"


def test_chi_square_is_the_likelihood_ratio_with_williams_correction():
    rng = np.random.default_rng()
    mass = rng.dirichlet(np.full(30, 5.0))
    counts = rng.multinomial(20_000, mass)
    expected = 20_000 * mass
    found = chi_square("", counts, mass, np.zeros(30), np.zeros(30), 1e-6)
    statistic = stats.power_divergence(counts, expected, lambda_="log-likelihood").statistic
    statistic /= 1 + (np.sum(1 / expected) - 1 / 20_000) / (6 * 29)
    assert found.p_value == near(stats.chi2.sf(statistic, 29), rel=1e-9)


def test_deviances_are_poissons():
    """Twice the log of the likelihood over its largest value."""
    observed, expected = np.array([0, 1, 3, 3, 40, 41]), np.array([0.2, 1.0, 3.0, 0.01, 31.0, 50.5])
    best, claimed = (stats.poisson.logpmf(observed, mean) for mean in (np.maximum(observed, 1e-300), expected))
    assert deviances(observed, expected) == pytest.approx(2 * (best - claimed), rel=1e-9, abs=1e-12)


def test_cells_are_pooled_until_each_expects_enough():
    rng = np.random.default_rng()
    for size in (1, 2, 7, 50):
        expected = rng.gamma(0.3, 20.0, size)
        groups = pooled(expected, 20.0)
        assert np.all(np.diff(groups) >= 0)
        assert set(groups) == set(range(groups.max() + 1))
        if expected.sum() >= 20:
            assert np.bincount(groups, expected).min() >= 20


def uniform_counts(cells, n, times):
    rng = np.random.default_rng()
    return rng.multinomial(n, np.full(cells, 1 / cells), times)


def test_levels_of_chi_square_smooth_and_sparse():
    mass, none = np.full(20, 0.05), np.zeros(20)
    held([chi_square("", c, mass, none, none, 1e-6).p_value for c in uniform_counts(20, 1000, 600)], 0.6)
    marginal = line(64)
    z = [smooth("", marginal, c, 1e-6) for c in uniform_counts(64, 3000, 600)]
    held([f.p_value for f in z], 0.6)
    assert z[0].p_value == near(stats.chi2.sf(z[0].statistic, 4), rel=1e-9) or z[0].p_value < 1e-4
    mass, none = np.full(300, 1 / 300), np.zeros(300)
    p = np.array([chi_square_sparse("", c, mass, none, 1e-6).p_value for c in uniform_counts(300, 300, 1500)])
    held(p, 0.6)
    assert abs(stats.norm.isf(p).std() - 1) < 6 / math.sqrt(2 * 1500), "its scatter is that of counts with a given sum"


def test_levels_of_scans_and_ends():
    """Bonferroni bounds over overlapping places: too large by a small factor, never too small."""
    marginal = line(64)
    counts = uniform_counts(64, 2000, 400)
    held([scan("", marginal, c, 1e-6).p_value for c in counts], 0.05)
    rng = np.random.default_rng()
    low, high = rng.beta(1, 2000, 400), rng.beta(2000, 1, 400)
    held([scan_ends("", marginal, c, a, b, 0.0, 1e-6).p_value for c, a, b in zip(counts, low, high, strict=True)], 0.05)


def test_the_extreme_sample_has_a_beta_law():
    n = 500
    for share in (1e-6, 1e-4, 2e-3, 0.02):
        law = stats.beta(1, n)
        assert _extreme_p(share, 0.0, n) == near(min(1, 2 * min(law.cdf(share), law.sf(share))), rel=1e-9)
        assert _extreme_p(share, 2 * share, n) >= _extreme_p(share, 0.0, n)


def test_levels_of_what_is_counted_on_a_plane():
    plane = unit_cube_grid(("x", "y"), 4096, 2.0**-52).plane
    size = plane.size
    counts = uniform_counts(size * size, 4096, 300).reshape(-1, size, size)
    coarse = [c.reshape(32, size // 32, 32, size // 32).sum(axis=(1, 3)) for c in counts]
    held([cross("", ("x", "y"), plane, c, 1e-6).p_value for c in coarse], 0.6)
    held([scan_plane("", ("x", "y"), plane, c, 1e-6).p_value for c in counts], 0.03)
    one = counts[0].copy()
    one[3, 5] += 40
    where = len(plane.mass) ** 2 * math.log2(len(plane.mass) / 2)
    expected = where * stats.binom.sf(one[3, 5] - 1, one.sum(), 1 / size**2) * 2
    assert scan_plane("", ("x", "y"), plane, one, 1e-6).p_value == near(min(1.0, expected), rel=1e-6)


def test_a_plane_of_dependent_axes_is_told_its_masses():
    """Given the masses of a correlated density, samples of it pass, and those of independent axes do not."""
    grid = unit_cube_grid(("x", "y"), 100_000, 2.0**-52).plane
    u = (np.arange(32) + 0.5) / 32
    mass = (1 + 0.5 * (2 * u[:, None] - 1) * (2 * u - 1)) / 1024
    plane = replace(grid, mass=mass, independent=False)
    rng = np.random.default_rng()
    right, wrong = (rng.multinomial(100_000, m.ravel() / m.sum()).reshape(32, 32) for m in (mass, np.full((32, 32), 1)))
    assert cross("", ("x", "y"), plane, right, 1e-6).p_value > 1e-9
    assert cross("", ("x", "y"), plane, wrong, 1e-6).p_value < 1e-9


def freedman(products, bound, variance):
    """Freedman's (1975) bound on the sum of bounded martingale differences, both ways."""
    total, n = abs(products.sum()), len(products)
    return 2 * math.exp(-(total**2) / (2 * (n * variance + bound * total / 3)))


def test_serial_correlation_has_freedmans_bound_and_counts_its_rivals():
    rng = np.random.default_rng()
    u = rng.random(700)
    u[1:] = np.where(rng.random(699) < 0.3, u[:-1], u[1:])
    scores = in_units(u)
    found = serial_test("", Successions.of([scores], False), 1e-6)
    x = scores / 2.0**15
    mean = max(abs(x.mean()), abs((2 * np.abs(x) - 0.5).mean()))  # of the score, and of its distance from the middle
    x -= x.mean()
    bound = (0.5 + mean) ** 2
    expected = 2 * 4 * freedman(x[:-1] * x[1:], bound, np.mean(x * x) ** 2)
    assert found.p_value == near(min(1.0, expected), rel=5e-2)
    u = rng.random(64 * 400)
    u[17:] = np.where(rng.random(len(u) - 17) < 0.06, u[:-17], u[17:])
    far = serial_test("", Successions.of([in_units(u)], True), 1e-6)
    assert "17 apart" in far.message
    x = np.floor((u - 0.5) * 64) / 64
    fold = np.floor((2 * np.abs(u - 0.5) - 0.5) * 64) / 64
    x, mean = x - x.mean(), max(abs(x.mean()), abs(fold.mean()))
    expected = 2 * 64 * 4 * freedman(x[:-17] * x[17:], (0.5 + mean) ** 2, np.mean(x * x) ** 2)
    assert math.log(far.p_value) == near(math.log(expected), rel=0.02)


def test_halves_of_a_call_are_compared():
    u = np.random.default_rng().random(64 * 200)
    u = np.concatenate([u, u])
    assert "halves" in serial_test("", Successions.of([in_units(u)], True), 1e-6).message


def record(x, size):
    return Succession.about(x[:, None]).after(x[:, None], [size] * (len(x) // size))


def test_levels_of_dependence():
    rng = np.random.default_rng()
    runs, spread, repeats = [], [], []
    for _ in range(160):
        x = rng.normal(size=3000)
        seen = record(x, 500)
        runs.append(runs_test("", seen, 1e-6).p_value)
        spread.append(spread_of_calls("", seen, [Moments.of(x)], 1e-6).p_value)
        coarse = rng.integers(0, 1500, 3000).astype(float)
        repeats.append(repeats_within_calls("", record(coarse, 500), 1e-6).p_value)
    held(runs, 0.2)
    held(spread, 0.5)
    held(repeats, 0.4)


def test_channels_share_the_scatter_of_calls():
    rng = np.random.default_rng()
    p = []
    for _ in range(120):
        x = rng.normal(size=(1600, 8))
        seen = Succession.about(x).after(x, [200] * 8)
        p.append(spread_of_calls("", seen, [Moments.of(np.ascontiguousarray(c)) for c in x.T], 1e-6).p_value)
    held(p, 0.4)


def test_few_pairs_have_the_hypergeometric_law():
    """A tail of few pairs, where a normal law would be wrong by a factor of ten."""
    rng = np.random.default_rng()
    p = [
        concordance(record(np.where(rng.random(2000) < 0.15, 1.0, rng.random(2000) * 0.5), 2000), 0, 0)[0]
        for _ in range(300)
    ]
    held(p)


def test_many_pairs_of_few_large_values_have_the_binomial_tail():
    rng = np.random.default_rng()
    large = rng.random(3000) < 0.1
    large[1:] |= large[:-1] & (rng.random(2999) < 0.15)
    seen = record(np.where(large, 1.0, rng.random(3000) * 0.5), 3000)
    share, pairs, both = int(seen.large[0]) / 3000, int(seen.pairs[0]), int(seen.both[0, 0])
    p, correlation, z = concordance(seen, 0, 0)
    assert z == near(correlation * math.sqrt(pairs), rel=1e-9)
    binomial = stats.binom(round(pairs * share), share)
    exact = 2 * min(binomial.sf(both - 1), binomial.cdf(both))
    assert p == near(max(2 * stats.norm.sf(abs(z)), min(1.0, exact)), rel=1e-6)


def test_scatter_of_calls_is_seen_both_ways():
    rng = np.random.default_rng()
    strata = np.concatenate([rng.permutation((np.arange(100) + rng.random(100)) / 100) for _ in range(40)])
    moved = np.concatenate([rng.random(100) + shift for shift in np.linspace(-0.5, 0.5, 40)])
    for x in (strata, moved):
        assert spread_of_calls("", record(x, 100), [Moments.of(x)], 1e-6).outcome == "rejected"


def test_mirrored_halves_and_streams_that_start_again_are_seen():
    rng = np.random.default_rng()
    x = rng.random(2000)
    mirrored = np.concatenate([x, x[::-1]])
    seen = record(mirrored, 4000)
    found = runs_test("", seen, 1e-6)
    assert "mirrored" in found.message
    assert found.outcome == "rejected"
    again = record(np.tile(rng.random(20_000), 2), 40_000)
    assert repeated_stretches("", again).outcome == "rejected"
    assert repeated_stretches("", record(rng.random(40_000), 40_000)).outcome == "not rejected"


def test_welch_is_scipys():
    rng = np.random.default_rng()
    for shift in (0.0, 0.15, 0.4):
        a, b = rng.gamma(4.0, size=3000), rng.normal(4.0 + shift, 1.0, 500)
        found = difference_test("", Moments.of(a), Moments.of(b), 1e-4)
        right = stats.ttest_ind(a, b, equal_var=False)
        error = math.sqrt(a.var(ddof=1) / 3000 + b.var(ddof=1) / 500)
        third = (stats.skew(a) * (a.std(ddof=1) / error) ** 3 / 3000**2) - (
            stats.skew(b) * (b.std(ddof=1) / error) ** 3 / 500**2
        )
        factor = math.exp(abs(third) / 3 * abs(right.statistic) ** 3)
        assert found.p_value == near(min(1.0, right.pvalue * factor), rel=2e-3)


def test_hits_of_unequal_numbers_are_not_compared_as_equal_ones():
    a, b = (Moments.of((np.arange(n) < n // 4).astype(float)) for n in (400, 4000))
    assert difference_test("", a, b, 1e-4).p_value > 0.5


def test_coverage_is_held_to_the_exact_binomial_tail():
    normal = Moments.of(np.random.default_rng().normal(size=500_000))
    squares, off = Moments.of(np.full(4, 1.0)), Moments.of(np.zeros(4))
    nominal = stats.norm.cdf(2) - stats.norm.cdf(-2)
    room = SLACK + 0.25 * normal.skewness**2
    for held_by in (4600, 4400, 4300):
        found = coverage_test("", Coverage(5000, held_by, (squares,)), [normal], [off], 1e-6)
        assert found.p_value == near(stats.binom.cdf(held_by, 5000, nominal - room), rel=1e-6)
        assert (found.outcome == "rejected") == (found.p_value <= 1e-6)
    some = Moments.of(np.random.default_rng().chisquare(20, 100_000) / 20)
    found = coverage_test("", Coverage(5000, 4400, (some,)), [normal], [off], 1e-6)
    nominal = 1 - 2 * stats.t.sf(2, degrees_of_freedom(some, normal))
    assert found.p_value == near(stats.binom.cdf(4400, 5000, nominal - room), rel=0.5)
    two = coverage_test("", Coverage(5000, 4100, (squares, squares)), [normal, normal], [off, off], 1e-6)
    nominal = 1 - 2 * 2 * stats.norm.sf(2)
    assert two.p_value == near(stats.binom.cdf(4100, 5000, nominal - 2 * room), rel=1e-6)
    skewed = Moments.of(np.random.default_rng().exponential(size=100_000))
    assert coverage_test("", Coverage(5000, 3400, (squares,)), [skewed], [off], 1e-6).outcome == "not rejected"


def test_the_tail_index_is_a_power_laws_with_its_error():
    rng = np.random.default_rng()
    suspected = [TailEstimate(0.0).after(rng.pareto(1.9, 60_000)).suspect() for _ in range(40)]
    assert sum(suspected) <= 12, "an index of 1.9 +- .2 is no proof"
    suspected = [TailEstimate(0.0).after(rng.pareto(0.9, 60_000)).suspect() for _ in range(30)]
    assert sum(suspected) >= 18, "that further out the index looks unlike by chance is rare"
    assert not any(TailEstimate(0.0).after(rng.exponential(size=60_000)).suspect() for _ in range(10))
    index, error = TailEstimate(0.0).after(rng.pareto(3.0, 400_000)).index()
    assert abs(index - 3) < 6 * error + 0.4


@pytest.mark.parametrize("n", [5, 50])
def test_means_of_exponential_numbers_have_their_own_law(n):
    """Of n exponential numbers, the mean is that much too small as often as said: half of the p-value is the other side."""
    x = np.random.default_rng().exponential(size=(20_000, n))
    z = (1 - x.mean(axis=1)) / (x.std(axis=1, ddof=1) / math.sqrt(n))
    for critical in (2.5, 4.0):
        seen = np.count_nonzero(z >= critical)
        stated = light_tailed_p(n, critical) / 2
        assert stats.binom.sf(seen - 1, 20_000, 1.05 * stated) > 1e-9
        assert stats.binom.cdf(seen, 20_000, stated / 1.3) > 1e-9


def test_bounds_and_variance_give_the_closed_forms():
    bright = Moments.of(np.full(30, 0.9))
    both = Known(low=0.0, high=1.0, variance=0.04)
    gap = 0.9 - 0.5
    by_variance, by_bounds = (0.04 / (0.04 + gap**2)) ** 30, (0.5 / 0.9) ** 30
    assert extremes_p(bright, 0.5, 0.5, Known(variance=0.04)) == near(2 * by_variance, rel=1e-9)
    assert extremes_p(bright, 0.5, 0.5, both) == near(4 * min(by_variance, by_bounds), rel=1e-9)
    some = Moments.of((np.arange(40) % 10 < 9).astype(float))
    kl = 0.9 * math.log(0.9 / 0.5) + 0.1 * math.log(0.1 / 0.5)
    assert extremes_p(some, 0.5, 0.5, Known(low=0.0, high=1.0)) == near(4 * math.exp(-40 * kl), rel=1e-9)


def test_levels_of_streams_are_scipys():
    rng = np.random.default_rng()
    x, y = rng.random(2000), rng.random(2000)
    found = _kolmogorov("", x, 1e-6)
    assert found.statistic == near(stats.kstest(x, "uniform").statistic, rel=1e-9)
    z = 12 * np.mean((x - 0.5) * (y - 0.5)) * math.sqrt(2000)
    assert _correlation("", x, y, 1e-6).p_value == near(2 * stats.norm.sf(abs(z)), rel=1e-9)
    held([_correlation("", *rng.random((2, 500)), 1e-6).p_value for _ in range(400)], 0.6)
    held([_pairs("", *rng.random((2, 4000)), 1e-6).p_value for _ in range(300)], 0.6)


def test_rivals_of_small_calls_are_counted():
    subject = Subject(lambda rng, n: rng.random(n), lambda x: np.ones(len(x)), Interval(0.0, 1.0), None)
    rng = np.random.default_rng()
    pilot, odd = rng.random(20_000), 0.8 * rng.random(4000)
    one, three = (
        one_law("", subject, {1000: odd, **{k: rng.random(50) for k in others}}, pilot, 1, 1e-6).p_value
        for others in ((), (1, 10))
    )
    assert three == near(3 * one, rel=1e-9)
    cube = Product(Interval(0.0, 1.0), Interval(0.0, 1.0))
    flat = Subject(lambda rng, n: rng.random((n, 2)), lambda x: np.ones(len(x)), cube, None)
    points = np.stack([odd, rng.random(4000)], axis=-1)
    two = one_law("", flat, {1000: points}, np.stack([pilot, rng.random(20_000)], axis=-1), 1, 1e-6).p_value
    assert two == near(2 * one, rel=1e-9)


def test_scatter_of_replicates_falls_as_slowly_as_is_allowed_and_no_slower():
    """Variances that fall as 1 / sqrt(n): inconclusive as rarely as alpha says, all counts and channels together."""
    rng = np.random.default_rng()
    sizes = [10, 160, 2560]
    slow = [(size / 10) ** -0.25 for size in sizes]
    odd = [
        _scatter([s * rng.normal(size=(24, 3)) for s in slow], sizes, 0.1)[0].outcome == "inconclusive"
        for _ in range(400)
    ]
    assert stats.binom.sf(sum(odd) - 1, 400, 0.1) > 1e-9, sum(odd)
    assert sum(odd) > 4
    still = [rng.normal(size=(200, 3)) for _ in sizes]
    assert _scatter(still, sizes, 1e-6)[0].outcome == "inconclusive"


def test_a_mean_of_skewed_numbers_has_students_law_and_halls_correction():
    rng = np.random.default_rng()
    for off in (0.0, 1.5, 3.0, 4.5):
        x = rng.gamma(4.0, size=3000)
        right = stats.ttest_1samp(x, x.mean() + off * x.std(ddof=1) / math.sqrt(3000))
        found = mean_test("", "", Moments.of(x), x.mean() + off * x.std(ddof=1) / math.sqrt(3000), 0.0, 1e-6)
        factor = math.exp(stats.skew(x) / (3 * math.sqrt(3000)) * off**3)
        assert found.p_value == near(min(1.0, right.pvalue * factor), rel=1e-2)


def test_few_skewed_or_short_samples_are_not_trusted():
    """Each for one reason, beside what is trusted."""
    rng = np.random.default_rng()
    half = rng.normal(size=2000)
    even = np.concatenate([half, -half])
    skewed = Moments.of(rng.gamma(0.25, 4.0, 20_000))
    flat = rng.random(60)
    for right, wrong in (
        (trusted(Moments.of(even), 1e-6), trusted(Moments.of(np.append(even, [60.0, -60.0])), 1e-6)),
        (trusted(skewed, 1e-2), trusted(skewed, 1e-12)),
        (
            trusted(Moments.of(np.concatenate([flat, -flat])), 0.1),
            trusted(Moments.of(np.concatenate([flat[:45], -flat[:45]])), 0.1),
        ),
        (
            trusted(Moments.of(even), 0.01, Known(variance=1.0)),
            trusted(Moments.of(even), 0.01, Known(variance=2.0)),
        ),
        (*(trusted(Moments.of((np.arange(150) < hits).astype(float)), 0.1) for hits in (2, 1)),),
    ):
        assert (right, wrong) == (True, False)


def test_a_mean_of_few_even_numbers_has_students_law_and_interval():
    half = np.random.default_rng().random(80)
    x = np.concatenate([half, -half])
    error = x.std(ddof=1) / math.sqrt(160)
    found = mean_test("", "", Moments.of(x), 4.5 * error, 0.0, 1e-6)
    assert found.p_value == near(2 * stats.t.sf(4.5, 159), rel=1e-4)
    assert found.interval.high - found.interval.low == near(
        2 * stats.t.isf((1 - found.interval.confidence) / 2, 159) * error, rel=1e-6
    )
