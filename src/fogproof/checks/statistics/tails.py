"""Tail probabilities of the laws the tests use, accurate to 1e-10 down to 1e-300, and the quantiles that sizes are planned with.

They rest on the incomplete beta and gamma functions of Boost (by way of SciPy), in the form that has no cancellation, as far as
these reach. SciPy's `bdtr`, `bdtrc` and `stdtr` do not: the last is wrong by 3e-5 at 1e-174.
"""

from __future__ import annotations

import math

import numpy as np

_MANY = 1e4  # degrees of freedom
_TINY = 1e-250  # Boost's incomplete beta function may underflow below
_TERMS = 1 << 14  # summed at once


def binomial_at_most(count: int, n: int, p: float) -> float:
    """Return P(X <= count) for X ~ Binomial(n, p)."""
    from scipy.special import betaincc

    if count >= n:
        return 1.0
    if count < 0:
        return 0.0
    tail = float(betaincc(count + 1, n - count, p))
    return tail if tail > _TINY or not 0 < p < 1 else _binomial_far(n - count, n, 1 - p, p)


def binomial_at_least(count: int, n: int, p: float) -> float:
    """Return P(X >= count) for X ~ Binomial(n, p)."""
    from scipy.special import betainc

    if count <= 0:
        return 1.0
    if count > n:
        return 0.0
    tail = float(betainc(count, n - count + 1, p))
    return tail if tail > _TINY or not 0 < p < 1 else _binomial_far(count, n, p, 1 - p)


def _binomial_far(count: int, n: int, p: float, q: float) -> float:
    """Return P(X >= count) far above the mean, term by term; q = 1 - p. Boost gives up some way before 1e-300.

    The first term is Loader's (2000, "Fast and accurate computation of binomial probabilities").
    """
    rest = n - count
    if rest == 0:
        return math.exp(n * math.log(p) if p < 0.5 else n * math.log1p(-q))
    log_first = _stirling_error(n) - _stirling_error(count) - _stirling_error(rest)
    log_first += -_deviance(count, n * p) - _deviance(rest, n * q)
    log_first += 0.5 * math.log(n / (2 * math.pi * count * rest))
    total, ratio, i = 1.0, 1.0, np.arange(float(count), min(float(n), count + _TERMS))
    while len(i):
        terms = ratio * np.cumprod((n - i) / (i + 1) * (p / q))
        total, ratio = total + float(terms.sum()), float(terms[-1])
        if ratio < 1e-17 * total:
            break
        i = np.arange(i[-1] + 1, min(float(n), i[-1] + 1 + _TERMS))
    return math.exp(log_first) * total


def _stirling_error(n: int) -> float:
    """Return log n! - log(sqrt(2 pi n) (n/e)^n)."""
    if n < 16:
        return math.lgamma(n + 1) - (0.5 * math.log(2 * math.pi * n) + n * math.log(n) - n)
    square = float(n) * n
    return (1 / 12 - (1 / 360 - (1 / 1260 - 1 / (1680 * square)) / square) / square) / n


def _deviance(x: float, mean: float) -> float:
    """Return x log(x / mean) + mean - x without cancellation."""
    if abs(x - mean) >= 0.1 * (x + mean):
        return x * math.log(x / mean) + mean - x
    v = (x - mean) / (x + mean)
    total, term, k = (x - mean) * v, 2 * x * v**3, 3
    while abs(term) > 1e-18 * abs(total):
        total += term / k
        term *= v * v
        k += 2
    return total


def binomial_interval(count: int, n: int, miss: float) -> tuple[float, float]:
    """Return the interval of Clopper & Pearson (1934) that holds the probability but for `miss`."""
    from scipy.special import betaincinv

    low = 0.0 if count == 0 else float(betaincinv(count, n - count + 1, miss / 2))
    high = 1.0 if count == n else float(betaincinv(count + 1, n - count, 1 - miss / 2))
    return low, high


def poisson_at_least(count: int, mean: float) -> float:
    """Return P(X >= count) for X ~ Poisson(mean)."""
    from scipy.special import gammainc

    return 1.0 if count <= 0 else float(gammainc(count, mean))


def gamma_above(shape: float, x: float) -> float:
    """Return P(X > x) for X ~ Gamma(shape, 1)."""
    from scipy.special import gammaincc

    return float(gammaincc(shape, max(x, 0.0)))


def chi_square_above(freedom: int, x: float) -> float:
    """Return P(X > x) for the chi-square law."""
    return gamma_above(0.5 * freedom, 0.5 * x)


def chi_square_detected(freedom: int, alpha: float, miss: float) -> float:
    """Return the non-centrality at which a chi-square test at `alpha` misses with probability `miss`."""
    from scipy.special import chndtrinc, gammainccinv

    return float(chndtrinc(2 * gammainccinv(0.5 * freedom, alpha), freedom, miss))


def student_two_sided(freedom: float, t: float) -> float:
    """Return P(|T| > |t|) for Student's law.

    With many degrees of freedom the incomplete beta function loses digits, and the tail is integrated: the density at t times the
    integral of what it decays by, of which nothing is left 60 decay lengths away.
    """
    from scipy.special import betaincc

    t = abs(t)
    if math.isinf(t):
        return 0.0
    if freedom < _MANY:
        return float(betaincc(0.5, 0.5 * freedom, t * t / (freedom + t * t)))
    ends = np.array([0.0, 1.0, 3.0, 7.0, 15.0, 31.0, 60.0]) / (t + 1)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    half, middle = 0.5 * np.diff(ends)[:, None], 0.5 * (ends[1:] + ends[:-1])[:, None]
    s = middle + half * nodes
    power = 0.5 * (freedom + 1)
    decay = np.exp(-power * np.log1p(s * (2 * t + s) / (freedom + t * t)))
    x = 0.5 * freedom  # Gamma(x + 1/2) / Gamma(x) by Stirling's series
    log_gammas = 0.5 * math.log(x) - 1 / (8 * x) + 1 / (192 * x**3)
    log_density = log_gammas - 0.5 * math.log(math.pi * freedom) - power * math.log1p(t * t / freedom)
    return min(1.0, 2 * math.exp(log_density) * float(np.sum(half * weights * decay)))


def normal_quantile(tail: float) -> float:
    """Return z with P(Z > z) = tail for a normal Z."""
    from scipy.special import ndtri

    return float(-ndtri(tail))


def normal_two_sided(z: float) -> float:
    """Return P(|Z| > |z|) for a normal Z."""
    return math.erfc(abs(z) / math.sqrt(2))
