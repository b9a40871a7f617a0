"""How large a bias would a test of a mean have caught?"""

from __future__ import annotations

import math
from collections.abc import Callable

from fogproof.checks.statistics.binomial import binomial_p
from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.tails import binomial_at_most, binomial_interval, normal_quantile


def student_reach(data: Moments, alpha: float, miss: float = MISS) -> float:
    """Return the bias that Student's test, corrected for skewness, finds but for the probability `miss`."""
    from scipy.special import stdtrit

    freedom = max(data.n - 1, 1)
    needed = -float(stdtrit(freedom, alpha / 2)) if freedom < 1e5 else normal_quantile(alpha / 2)
    growth = abs(data.skewness) / (3 * math.sqrt(data.n))
    for _ in range(20):  # exp(growth z^3) of the p-value has to be made up for
        needed = normal_quantile(max(alpha / 2 * math.exp(-min(growth * needed**3, 50.0)), 1e-300))
    return (needed + normal_quantile(miss)) * data.stderr * (1 + growth)


def binomial_reach(
    n: int,
    low: float,
    high: float,
    alpha: float,
    miss: float = MISS,
    least: int = 0,
    margins: tuple[float, float] = (0.0, 0.0),
) -> float:
    """Return the smallest change of a probability in [low, high] that the exact binomial test finds but for `miss`, both ways.

    least    how often hits, and misses, must have come for the test to be used at all
    margins  by how many a count must be too small, and too large, besides
    Where not even a probability of zero would be found, it is the whole probability.
    """
    part = miss if least == 0 else 0.9 * miss  # the rest for fewer than `least`
    many = _first(lambda count: binomial_p(count, n, low, high) <= alpha, math.ceil(n * high + margins[1]), n)
    few = _first(lambda misses: binomial_p(n - misses, n, low, high) <= alpha, math.ceil(n * (1 - low) + margins[0]), n)
    rise = _found(n, many, part, least, miss - part)
    fall = _found(n, few, part, least, miss - part)
    return max((1 if rise is None else rise) - high, low - (0 if fall is None else 1 - fall), 0.0)


def _found(n: int, count: int | None, miss: float, least: int, rare: float) -> float | None:
    """Return the smallest probability that leads to so many hits but for `miss`; None if `least` misses may then be wanting."""
    from scipy.special import betaincinv

    if count is None:
        return None
    p = float(betaincinv(count, n - count + 1, 1 - miss))
    return None if least and binomial_at_most(least - 1, n, 1 - p) > rare else p


def sign_reach(n: int, differ: int, alpha: float) -> float:
    """Return the difference of two probabilities that the sign test finds in n pairs but for `MISS`; `differ` pairs were unlike.

    It grows with the share of unlike pairs, of which `differ` tells an upper bound, and no share so small can be told that too few
    pairs would be unlike for any rejection, were all of them unlike in the same direction.
    """
    from scipy.special import betaincinv

    part = MISS / 4  # a quarter for each bound on the unlike pairs, half for the test
    least = math.ceil(math.log2(2 / alpha))
    if least > n:
        return 1.0
    barely = float(betaincinv(least, n - least + 1, 1 - part))
    share = max(binomial_interval(differ, n, 2 * part)[1], barely)
    unlike = _first(lambda count: binomial_at_most(count, n, share) > part, 0, n)
    assert unlike is not None
    return max(2 * share * binomial_reach(unlike, 0.5, 0.5, alpha, 2 * part), barely)


def _first(holds: Callable[[int], bool], start: int, end: int) -> int | None:
    """Return the first whole number in [start, end] from which on `holds` is true, None if there is none."""
    if start > end or not holds(end):
        return None
    while start < end:
        middle = (start + end) // 2
        start, end = (start, middle) if holds(middle) else (middle + 1, end)
    return start
