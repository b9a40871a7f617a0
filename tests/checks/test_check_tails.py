"""Every p-value is right to 1e-10 down to 1e-300: each law's tail against sums and continued fractions in 50 digits."""

import mpmath as mp
import numpy as np
import pytest

from fogproof.checks.statistics import tails

RELATIVE = 1e-10
SEED = int(np.random.SeedSequence().generate_state(1)[0])


@pytest.fixture(autouse=True)
def fifty_digits():
    with mp.workdps(50):
        yield


def upper_gamma(a, x):
    """Q(a, x) for x > a by Lentz's continued fraction."""
    a, x = mp.mpf(a), mp.mpf(x)
    b = x + 1 - a
    c, d = mp.mpf(10) ** 300, 1 / b
    h, i = d, 1
    while True:
        an = -i * (i - a)
        b += 2
        d = 1 / (an * d + b)
        c = b + an / c
        h *= d * c
        if abs(d * c - 1) < mp.mpf(10) ** -40:
            return mp.exp(-x + a * mp.log(x) - mp.loggamma(a)) * h
        i += 1


def lower_gamma(a, x):
    """P(a, x) by its power series."""
    a, x = mp.mpf(a), mp.mpf(x)
    term = total = mp.exp(-x + a * mp.log(x) - mp.loggamma(a + 1))
    i = 1
    while term > total * mp.mpf(10) ** -40:
        term *= x / (a + i)
        total += term
        i += 1
    return total


def binomial_sum(count, n, p):
    """P(X >= count), term by term."""
    p = mp.mpf(p)
    term = mp.binomial(n, count) * p**count * (1 - p) ** (n - count)
    total = term
    for i in range(count, n):
        term *= mp.mpf(n - i) / (i + 1) * p / (1 - p)
        total += term
        if term < total * mp.mpf(10) ** -18:
            break
    return total


def student(freedom, t):
    """P(|T| > t) for t > 2: the incomplete beta function by its continued fraction (DLMF 8.17.22)."""
    a, b, x = mp.mpf(freedom) / 2, mp.mpf(1) / 2, mp.mpf(freedom) / (freedom + mp.mpf(t) ** 2)
    c, d, h = mp.mpf(1), mp.mpf(0), mp.mpf(1)
    m = 1
    while True:
        k = m // 2
        if m % 2:
            step = -(a + k) * (a + b + k) * x / ((a + 2 * k) * (a + 2 * k + 1))
        else:
            step = k * (b - k) * x / ((a + 2 * k - 1) * (a + 2 * k))
        d, c = 1 / (1 + step * d), 1 + step / c
        h *= c * d
        if abs(c * d - 1) < mp.mpf(10) ** -40:
            break
        m += 1
    log_beta = mp.loggamma(a) + mp.loggamma(b) - mp.loggamma(a + b)
    return mp.exp(a * mp.log(x) + b * mp.log(1 - x) - log_beta) / (a * h)


def agree(got, right):
    if 1e-300 < right < 1:
        assert abs(got - right) <= RELATIVE * right, f"{got} against {mp.nstr(right, 17)} (seed {SEED})"


@pytest.mark.parametrize(("nearest", "farthest", "most"), [(0, 37, 7), (25, 45, 6)])
def test_binomial(nearest, farthest, most):
    """Both tails up to 45 standard deviations out, where the incomplete beta function itself gives up."""
    rng = np.random.default_rng(SEED)
    for _ in range(40):
        n, p = int(10 ** rng.uniform(1, most)), float(10 ** rng.uniform(-most, -0.01))
        away = (np.sqrt(n * p * (1 - p)) + 1) * rng.uniform(nearest, farthest)
        above, below = min(int(n * p + away) + 1, n), max(int(n * p - away), 0)
        agree(tails.binomial_at_least(above, n, p), binomial_sum(above, n, p))
        agree(tails.binomial_at_most(below, n, p), binomial_sum(n - below, n, 1 - mp.mpf(p)))


def test_binomial_ends():
    assert tails.binomial_at_least(0, 10, 0.3) == tails.binomial_at_most(10, 10, 0.3) == 1
    assert tails.binomial_at_least(11, 10, 0.3) == tails.binomial_at_most(-1, 10, 0.3) == 0
    assert tails.binomial_at_least(3, 10, 0.0) == tails.binomial_at_most(3, 10, 1.0) == 0
    agree(tails.binomial_at_most(0, 1000, 0.4), mp.mpf("0.6") ** 1000)
    agree(tails.binomial_at_least(500, 500, 0.3), mp.mpf(0.3) ** 500)


def test_chi_square_gamma_and_poisson():
    rng = np.random.default_rng(SEED)
    for _ in range(60):
        freedom = int(10 ** rng.uniform(0, 5.4))
        x = float(freedom + np.sqrt(2 * freedom) * rng.uniform(0.1, 38))
        agree(tails.chi_square_above(freedom, x), upper_gamma(mp.mpf(freedom) / 2, mp.mpf(x) / 2))
        mean = float(10 ** rng.uniform(-6, 4))
        count = int(mean + np.sqrt(mean) * rng.uniform(0, 30)) + 1
        agree(tails.poisson_at_least(count, mean), lower_gamma(count, mean))


def test_student():
    rng = np.random.default_rng(SEED)
    for _ in range(25):
        freedom, t = int(10 ** rng.uniform(2, 8)), float(rng.uniform(2.1, 36))
        agree(tails.student_two_sided(freedom, t), student(freedom, mp.mpf(t)))
    assert tails.student_two_sided(1000, np.inf) == 0
    for freedom in (100, 10**4 - 1, 10**4, 10**7):
        assert tails.student_two_sided(freedom, 0.0) == pytest.approx(1, abs=1e-12)


def test_normal():
    for z in np.linspace(0.1, 37, 50).tolist():
        agree(tails.normal_two_sided(z), mp.erfc(mp.mpf(z) / mp.sqrt(2)))
    for tail in 10.0 ** -np.linspace(0.5, 299, 40):
        z = tails.normal_quantile(float(tail))
        assert abs(mp.ncdf(-mp.mpf(z)) / tail - 1) < 1e-9  # a quantile plans a size, it judges nothing


def test_quantiles_invert():
    for count, n in ((0, 10), (3, 1000), (999_000, 1_000_000), (10, 10)):
        low, high = tails.binomial_interval(count, n, 0.01)
        assert tails.binomial_at_least(count, n, low) == pytest.approx(0.005 if count else 1)
        assert tails.binomial_at_most(count, n, high) == pytest.approx(0.005 if count < n else 1)
    from scipy.stats import chi2, ncx2

    for freedom, alpha in ((1, 1e-6), (4, 1e-8), (9, 1e-3)):
        found = tails.chi_square_detected(freedom, alpha, 0.01)
        assert ncx2.cdf(chi2.isf(alpha, freedom), freedom, found) == pytest.approx(0.01, rel=1e-6)
