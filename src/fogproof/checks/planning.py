"""`samples_for`: how many realisations does `check_estimator` need to find a bias of a given size?

The check is planned as it is carried out: its mean has so much of alpha beside the dependence of realisations and the tests that
hold for every law. Student's test of a normal law needs (z_alpha + z_miss)^2 v / b^2 realisations. Two values get the exact power
of the binomial test; where only the variance is known, the guarantee of Catoni's test (2012) holds; where there are bounds alone,
Hoeffding's inequality (1963).
"""

from __future__ import annotations

import math
from collections.abc import Callable

from fogproof.checks.arguments import bounds_of, whole
from fogproof.checks.judgement import share_of_means
from fogproof.checks.statistics.bets import Bets
from fogproof.checks.statistics.extremes import detectable
from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.light import light_tailed_reach
from fogproof.checks.statistics.power import binomial_reach
from fogproof.checks.statistics.tails import normal_quantile
from fogproof.errors import InvalidValueError
from fogproof.validate import number

_FEW = 1000
_MOST = 10**15


def samples_for(
    *,
    bias: float,
    variance: float | None = None,
    probability: float | None = None,
    bounds: tuple[float, float] | None = None,
    whatever_the_law: bool = False,
    channels: int = 1,
    false_fail: float = 1e-6,
    false_pass: float = 0.01,
) -> int:
    """Return how many realisations `check_estimator` needs to find a bias, but for the probability `false_pass`.

    bias              smallest one that must be found, in the unit of the values
    variance          of one realisation; averages of many paths are about normal. Fewer than a thousand need tails="light"
    probability       of a hit, for an estimator of hits (1) and misses (0): its mean; the bias is one of that probability. Declare
                      bounds=(0, 1) to the check: without them it says nothing of hits, or misses, that are all but missing
    bounds            (low, high) of the values, where nothing else is known of them
    whatever_the_law  plan for rare bright values: `variance` must then be declared to the check too
    channels          how many means share the false alarms
    false_fail        the check's alpha
    false_pass        probability of missing the bias

    >>> samples_for(bias=0.01, variance=0.25)
    131360
    >>> samples_for(bias=0.01, probability=0.5) <= 150_000
    True
    """
    number("bias", bias, "must be > 0", 0, open_ends=True)
    number("false_fail", false_fail, "must lie in (0, 1)", 0, 1, open_ends=True)
    number("false_pass", false_pass, "must lie in (0, 0.5]", 0, 0.5)
    channels = whole("channels", channels, 1)
    if [variance, probability, bounds].count(None) != 2:
        given = {"variance": variance, "probability": probability, "bounds": bounds}
        raise InvalidValueError("variance, probability or bounds", "must be given, one of them", given)
    declared = bounds is not None or probability is not None or whatever_the_law
    claims = channels * (2 if whatever_the_law else 1)
    usual, distribution_free, bets = share_of_means(false_fail, claims, declared)
    if probability is not None:
        p = number("probability", probability, "must lie in [0, 1]", 0, 1)
        number("bias", bias, "must leave a probability, one way at least", 0, max(p, 1 - p))
        return _smallest(lambda n: binomial_reach(n, p, p, usual, false_pass), bias)
    if bounds is not None:
        low, high = bounds_of(bounds)
        if not math.isfinite(high - low):
            raise InvalidValueError("bounds", "must be finite to plan by them; give variance= instead", bounds)
        number("bias", bias, "must be possible within the bounds", 0, high - low)
        known = Known(low=low, high=high)
        return _smallest(lambda n: detectable(n, known, distribution_free, false_pass), bias)
    v = number("variance", variance, "must be > 0", 0, open_ends=True)
    if whatever_the_law:
        return _smallest(lambda n: Bets(0.0, 0.0, Known(v), n, bets).detectable(false_pass), bias)

    def reach(n: int) -> float:
        few = n < _FEW
        both = normal_quantile(usual / 2) + normal_quantile(false_pass)
        return (light_tailed_reach(n, usual, false_pass) if few else both) * math.sqrt(v / n)

    return _smallest(reach, bias)


def _smallest(reach: Callable[[int], float], bias: float) -> int:
    """Return the smallest n whose reach is the bias at most; the reach of hits is not quite monotone, its trend is."""
    high = 2
    while reach(high) > bias:
        high *= 2
        if high > _MOST:
            raise InvalidValueError("bias", f"must be large enough for {_MOST:g} realisations to show it", bias)
    low = high // 2
    while high - low > max(1, low >> 20):
        middle = (low + high) // 2
        low, high = (low, middle) if reach(middle) <= bias else (middle, high)
    return high
