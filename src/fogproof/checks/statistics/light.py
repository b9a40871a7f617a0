"""Student's test where realisations are few and their tails are declared to be light.

Few realisations cannot show how skewed their law is. Where it is declared to be no heavier than the exponential law, the p-value is
the larger of those of the normal law and of the exponential one. There the quotient of the scatter S and the mean X of n
realisations is independent of X (Basu 1955): a mean is t standard errors too small with E P(Gamma(n) < n / (1 + t S / (X sqrt n))).
"""

from __future__ import annotations

import functools
import math

import numpy as np

from fogproof.checks.statistics.tails import normal_quantile, student_two_sided

_FEW = 1000
_SAMPLE = 4000


def light_tailed_p(n: int, z: float) -> float:
    """Return the p-value of a mean of n realisations that is z standard errors off, either way."""
    student = student_two_sided(n - 1, z)
    if z <= 0 or not math.isfinite(z):
        return student
    if n > _FEW:
        return min(1.0, student * math.exp(min(2 / (3 * math.sqrt(n)) * min(z, n**0.25) ** 3, 50.0)))
    from scipy.special import gammainc

    exponential = float(np.mean(gammainc(n, n / (1 + z * _scatter(n) / math.sqrt(n)))))
    return min(1.0, max(student, 2 * exponential))


def light_tailed_reach(n: int, alpha: float, miss: float = 0.01) -> float:
    """Return the bias, in standard errors, that is found but for the probability `miss`; inf if none is.

    The critical value by bisection, for a standard error that is unluckily large, and as much again as chance takes from the mean.
    """
    from scipy.special import gammaincinv

    low, high = 1.0, 1e9
    if n < 2 or light_tailed_p(n, high) > alpha:
        return math.inf
    while high > low * (1 + 1e-6):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if light_tailed_p(n, middle) > alpha else (low, middle)
    unlucky = math.sqrt(float(gammaincinv(0.5 * (n - 1), 1 - 0.5 * miss)) / (0.5 * (n - 1)))
    return high * unlucky + normal_quantile(0.5 * miss)


@functools.lru_cache(maxsize=16)
def _scatter(n: int) -> np.ndarray:
    """Return a sample of the law of S / X, an integration rule: the same numbers every time."""
    x = np.random.default_rng(n).exponential(size=(_SAMPLE, n))
    return x.std(axis=1, ddof=1) / x.mean(axis=1)
