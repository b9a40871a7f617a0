"""A mean judged by whole replicates, which are independent of each other whatever their realisations are.

So are judged scrambled points, and calls whose realisations depend on each other.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.tails import normal_quantile, student_two_sided
from fogproof.checks.verdict import EffectInterval, Finding, Outcome, Resolution
from fogproof.study.between_replicates import BetweenReplicates


def judged_by_replicates(
    what: str,
    means: np.ndarray,
    value: float,
    error: float,
    alpha: float,
    *,
    step: float = 0.0,
    cause: str = "bias",
    name: str = "",
) -> Finding:
    """Judge the mean of replicates' means: few, and far from normal where points fit the function.

    Only what skewness cannot explain is rejected: Student's p-value grows by its correction at alpha. Means that are all alike say
    nothing finer than one realisation more or less: of hits and misses a net can have the same number under every scrambling.

    means  (replicates,)
    step   by how much one realisation can move the mean of a replicate
    """
    data = Moments.of(means)
    data.values = None  # no hits and misses
    off = data.mean - value
    resolution, interval = None, None
    if data.n < 2:
        return Finding(name or what, "inconclusive", f"{what} of a single replicate {data.mean:.9g}", alpha=alpha)
    if data.m2 > 0:
        z = max(abs(off) - error, 0.0) / data.stderr
        growth = min(abs(data.skewness) / (3 * math.sqrt(data.n)) * normal_quantile(alpha / 2) ** 3, 700.0)
        p = min(1.0, student_two_sided(data.n - 1, z) * math.exp(growth))
        reach = student_quantile(data.n - 1, MISS / 2) * data.stderr + error
        interval = EffectInterval(off - reach, off + reach, 1 - MISS)
        found = _found(data.n - 1, alpha * math.exp(-growth)) * data.stderr + error
        resolution = Resolution(f"bias of {what}", found, MISS, value) if math.isfinite(found) else None
    else:
        # Where no point differs from another, rare values may be missing: random points, which are more, are asked about those.
        p = 1.0 if step == 0 or abs(off) <= error + step else 0.0
        resolution = Resolution(f"bias of {what}", error + step, 0.0, value) if step else None
    outcome: Outcome = "rejected" if p <= alpha else "not rejected"
    message = f"{what} of {data.n} replicates {data.mean:.9g} +- {data.stderr:.2g}, reference {value:.9g}"
    return Finding(
        name or what, outcome, message, p, alpha, effect=off, resolution=resolution, interval=interval,
        cause=cause if p <= alpha else "",
    )  # fmt: skip


def student_quantile(freedom: float, tail: float) -> float:
    """Return t with P(T > t) = tail."""
    from scipy.special import stdtrit

    return -float(stdtrit(freedom, tail))


def _found(freedom: int, alpha: float) -> float:
    """Return how many standard errors a bias is that Student's test finds but for `MISS` at most.

    Half of that is for a standard error that comes out so much larger than it is, half for a mean so much nearer.
    """
    from scipy.special import chdtri

    larger = math.sqrt(float(chdtri(freedom, MISS / 2)) / freedom)
    return student_quantile(freedom, max(alpha, 1e-300) / 2) * larger + normal_quantile(MISS / 2)


def as_calls_allow(found: Finding, between: BetweenReplicates, own: Finding) -> Finding:
    """Return what may be said of a mean of realisations: `found` takes them as independent, `own` is judged by replicates.

    Where calls are in doubt, what is rejected must be so both ways, which spends no more than either, and what is said
    holds both ways.
    """
    if between.by_replicates:
        unseen = own.interval is None and found.outcome != "not rejected" and own.outcome == "not rejected"
        return replace(own, outcome="inconclusive", p_value=None) if unseen else own
    found = _widened(found, math.sqrt(between.design_effect))
    if between.calls == "independent":
        return found
    if found.outcome != "rejected":
        return _wider(found, own)
    if own.outcome == "rejected":
        return own
    message = f"{own.message}; realisations of one call may depend on each other: ask for more replicates"
    return replace(own, outcome="inconclusive", message=message, p_value=None)


def _widened(found: Finding, factor: float) -> Finding:
    """Return the finding, its interval and resolution so many times as wide."""
    if factor == 1 or found.interval is None or found.effect is None:
        return found
    low, high = (found.effect + factor * (end - found.effect) for end in (found.interval.low, found.interval.high))
    resolution = found.resolution and replace(found.resolution, value=factor * found.resolution.value)
    return replace(found, interval=replace(found.interval, low=low, high=high), resolution=resolution)


def _wider(found: Finding, own: Finding) -> Finding:
    """Return the finding, its interval and resolution as wide as its own and that of replicates."""
    if found.interval is not None and own.interval is not None and found.effect is not None and own.effect is not None:
        low = min(found.interval.low, found.effect + own.interval.low - own.effect)
        high = max(found.interval.high, found.effect + own.interval.high - own.effect)
        found = replace(found, interval=replace(found.interval, low=low, high=high))
    if found.resolution is not None and own.resolution is not None:
        value = max(found.resolution.value, own.resolution.value)
        found = replace(found, resolution=replace(found.resolution, value=value))
    return found
