"""Do two samples have the same expectation? Their moments are all that is needed.

Welch's test (1947) of two means with unequal variances, its far tail corrected for skewness as for one mean. Two samples that hit
or miss the same values are compared exactly: given the hits of both together, those of the first are hypergeometric, and a binomial
law bounds that. Where one never varies, nothing is known of its rare values, and nothing is said.
"""

from __future__ import annotations

import math

from fogproof.checks.statistics.binomial import binomial_p
from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.means import LARGEST_CORRECTION, LARGEST_SHARE
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.tails import normal_quantile, student_two_sided
from fogproof.checks.verdict import EffectInterval, Finding, Outcome, Resolution


def difference_test(name: str, a: Moments, b: Moments, alpha: float) -> Finding:
    """Test that two samples have the same expectation."""
    effect = a.mean - b.mean
    errors = [0.0 if one.m2 == 0 else one.stderr for one in (a, b)]
    stderr = math.hypot(*errors)
    reach = normal_quantile(0.5 * MISS) * stderr
    interval = EffectInterval(effect - reach, effect + reach, 1 - MISS)
    message = f"means {a.mean:.7g} and {b.mean:.7g} differ by {effect:+.3g} +- {stderr:.2g}"
    power = (normal_quantile(alpha / 2) + normal_quantile(MISS)) * stderr
    resolution = Resolution(name, power, MISS)
    values = None if a.values is None or b.values is None else {*a.values, *b.values}
    exact = values is not None and len(values) == 2 and a.n == b.n
    if stderr == 0:
        same = abs(effect) <= 1e-12 * max(abs(a.mean), abs(b.mean))
        outcome: Outcome = "not rejected" if same else "inconclusive"
        more = "" if same else "; neither varies: ask for more samples, or compare the numbers"
        return Finding(name, outcome, message + more, effect=effect, resolution=resolution)
    if exact:
        high = max(values or ())
        hits = (a.values or {}).get(high, 0), (b.values or {}).get(high, 0)
        rarer = hits if sum(hits) <= a.n else (a.n - hits[0], b.n - hits[1])
        p, z = binomial_p(rarer[0], sum(rarer), 0.5, 0.5), effect / stderr
        message += " (exact test of hits)"
    elif min(errors) == 0:
        message += (
            "; one of them never varies, and a value too rare to be seen may hold the difference: ask for more samples"
        )
        return Finding(name, "inconclusive", message, None, alpha, effect=effect, interval=interval)
    else:
        weights = [error / stderr for error in errors]
        third = a.skewness * weights[0] ** 3 / math.sqrt(a.n) - b.skewness * weights[1] ** 3 / math.sqrt(b.n)
        growth = abs(third) / 3
        needed = normal_quantile(alpha / 2)
        if growth * needed**3 > LARGEST_CORRECTION or max(a.largest_share, b.largest_share) > LARGEST_SHARE:
            message += "; too skewed for a test at this alpha: ask for more samples"
            return Finding(
                name, "inconclusive", message, None, alpha, effect=effect, resolution=resolution, interval=interval
            )
        freedom = 1 / (weights[0] ** 4 / (a.n - 1) + weights[1] ** 4 / (b.n - 1))
        z = effect / stderr
        limit = max(needed, (LARGEST_CORRECTION / growth) ** (1 / 3)) if growth > 0 else math.inf
        p = min(1.0, student_two_sided(freedom, z) * math.exp(growth * min(abs(z), limit) ** 3))
    rejected = p <= alpha
    return Finding(
        name,
        "rejected" if rejected else "not rejected",
        message,
        p,
        alpha,
        not exact,
        z,
        effect,
        resolution,
        interval=interval,
        region=("the first is the larger",)
        if rejected and effect > 0
        else ("the second is the larger",)
        if rejected
        else (),
        cause="bias" if rejected else "",
    )
