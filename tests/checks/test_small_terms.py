"""Small terms that no verdict shows at a glance, each held to what it is defined as or to many draws."""

import math

import numpy as np
import pytest
from scipy import stats

from fogproof.checks import check_convergence, samples_for
from fogproof.checks.density import quadrature
from fogproof.checks.diagnosis.hypothesis import Hypothesis
from fogproof.checks.judgement import share_of_means
from fogproof.checks.statistics.labels import _chi_square, tail


def test_quadrature_is_exact_for_the_polynomials_it_is_made_for():
    """Kronrod's 15 nodes up to degree 22, Gauss' 7 up to 13 (Kronrod 1965): every weight has its digits."""
    for weights, degree in ((quadrature.KRONROD, 22), (quadrature.GAUSS, 13)):
        for k in range(degree + 1):
            truth = 0.0 if k % 2 else 2 / (k + 1)
            assert abs(math.fsum(weights * quadrature.NODES**k) - truth) < 5e-16


def test_a_parameter_costs_half_the_logarithm_of_the_samples():
    """Schwarz 1978: of two laws that explain as much, the one with fewer parameters is told."""
    plain = Hypothesis("a", "b", lambda setting, value: None)
    fitted = Hypothesis("a", "b", lambda setting, value: None, trials=(0.5,))
    known = Hypothesis("a", "b", lambda setting, value: None, fitted=2)
    likely = Hypothesis("a", "b", lambda setting, value: None, trials=(0.5,), prior=3.0)
    prices = [one.price(10**6) for one in (plain, fitted, known, likely)]
    assert prices == pytest.approx([0, math.log(1e3), 2 * math.log(1e3), math.log(1e3) - 3])


@pytest.mark.parametrize(("alpha", "miss"), [(1e-6, 0.01), (1e-3, 0.1)])
def test_a_plan_is_two_sided(alpha, miss):
    usual = share_of_means(alpha, 1, False)[0]
    wanted = (stats.norm.isf(usual / 2) + stats.norm.isf(miss)) ** 2 * 0.25 / 0.01**2
    assert samples_for(bias=0.01, variance=0.25, false_fail=alpha, false_pass=miss) == pytest.approx(wanted, rel=1e-4)


def test_errors_that_creep_up_grow():
    """Each is a tolerance above the one before, at most; the last is nearly two above the first."""
    errors = dict(zip((10, 100, 1000, 10_000), (0.010, 0.019, 0.028, 0.027), strict=True))
    verdict = check_convergence(
        lambda rng, n: 1 + errors[n], list(errors), reference=1.0, tolerance=(0, 0.01), replicates=8
    )
    found = [f.outcome for f in verdict.findings if f.check.startswith("error with")]
    assert found == ["not rejected", "not rejected", "inconclusive", "inconclusive"]


@pytest.mark.parametrize("coins", [3, 12, 60])
def test_chi_square_of_sums_of_unlike_coins(coins):
    """p-values of right coins are uniform, though each sum has a law of its own."""
    rng, cells, runs = np.random.default_rng(), 40, 3000
    p = rng.uniform(0.05, 0.95, (cells, coins))
    v = p * (1 - p)
    columns = np.stack([v.sum(axis=1), (v * (1 - 2 * p)).sum(axis=1), (v * v).sum(axis=1)])
    found = []
    for _ in range(runs):
        total = ((rng.random(p.shape) < p) - p).sum(axis=1)
        found.append(_chi_square("sums", np.stack([total, *columns]), 1e-9).p_value)
    assert stats.kstest(found, "uniform").pvalue > 1e-6


def test_a_sum_of_few_coins_has_bennetts_bound_on_either_side():
    """Bennett 1962: exp(-v h(t / v)), h(u) = (1 + u) log(1 + u) - u, twice; many coins have the normal law's tail."""
    total, variance = np.array([3.0, -3.0, 20.0]), np.array([2.0, 2.0, 10.0])
    h = (1 + 1.5) * math.log(2.5) - 1.5, (1 + 2.0) * math.log(3.0) - 2.0
    expected = [2 * math.exp(-2 * h[0])] * 2 + [2 * math.exp(-10 * h[1])]
    assert tail(total, variance, np.zeros(3)) == pytest.approx(expected, rel=1e-12)
    assert tail(np.array([50.0]), np.array([400.0]), np.zeros(1)) == pytest.approx(2 * stats.norm.sf(2.5), rel=1e-12)
