"""`compare_estimators`: do two estimators have the same expectation, where nobody knows it?

Welch's test (1947) of two means with unequal variances, its far tail corrected for skewness as for one mean. Two estimators that
hit or miss the same values are compared exactly: given the hits of both together, those of the first are hypergeometric, and a
binomial law bounds that.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.checks.diagnosis import likely_cause
from fogproof.checks.statistics.goodness import MISS, binomial_p
from fogproof.checks.statistics.means import LARGEST_CORRECTION, LARGEST_SHARE, Moments
from fogproof.checks.statistics.tails import normal_quantile, student_two_sided
from fogproof.checks.streams import batch_generator, batch_sizes, fresh_seed
from fogproof.checks.subject import call
from fogproof.checks.verdict import Finding, Interval, Outcome, Resolution, Verdict
from fogproof.contracts import Draws
from fogproof.errors import SubjectError
from fogproof.validate import number

Draw = Callable[[np.random.Generator, int], Any]


def compare_estimators(
    first: Draw, second: Draw, *, samples: int = 1_000_000, alpha: float = 1e-6, seed: int | None = None
) -> Verdict:
    """Test that two estimators have the same expectation, channel by channel, inside one false-alarm probability `alpha`.

    first, second  `draw(rng, n)` -> (n,) or (n, channels) independent realisations, or `Draws`
    samples        how many realisations of each
    seed           any whole number; None draws a fresh one, which the verdict states
    """
    started = time.perf_counter()
    number("alpha", alpha, "must lie in (0, 1)", 0, 1, open_ends=True)
    number("samples", samples, "must be at least 100", 100)
    seed = fresh_seed() if seed is None else seed
    data = [_moments(name, draw, samples, seed) for name, draw in (("first", first), ("second", second))]
    if len(data[0]) != len(data[1]):
        message = f"both estimators must have as many channels, got {len(data[0])} and {len(data[1])}"
        raise SubjectError(message, "draw: value")
    findings = []
    for channel, (a, b) in enumerate(zip(*data, strict=True)):
        name = "difference" if len(data[0]) == 1 else f"difference in channel {channel}"
        findings.append(difference_test(name, a, b, alpha / len(data[0])))
    names = ", ".join(getattr(draw, "__qualname__", type(draw).__name__) for draw in (first, second))
    reproduce = f"compare_estimators({names}, samples={samples}, alpha={alpha:g}, seed={seed})"
    seconds = time.perf_counter() - started
    return Verdict(
        tuple(findings), alpha, samples, seed, seconds, {"channels": len(data[0])}, likely_cause(findings), reproduce
    )


def _moments(name: str, draw: Draw, samples: int, seed: int) -> list[Moments]:
    total: list[Moments] = []
    for index, n in enumerate(batch_sizes(samples)):
        result = call(f"{name} draw(rng, n)", draw, batch_generator(seed, f"compare {name}", 0, index), n)
        x = np.asarray(result.value if isinstance(result, Draws) else result)
        if x.dtype.kind not in "iufb" or x.ndim not in (1, 2) or len(x) != n:
            raise SubjectError(
                f"{name} draw must return ({n},) or ({n}, channels) numbers, got {x.shape}", "draw: value"
            )
        if not np.isfinite(x).all():
            raise SubjectError(f"{name} draw returned numbers that are not finite", "draw: value")
        new = [Moments.of(np.ascontiguousarray(column)) for column in x.reshape(n, -1).astype(np.float64).T]
        total = [a.merged(b) for a, b in zip(total, new, strict=True)] if total else new
    return total


def difference_test(name: str, a: Moments, b: Moments, alpha: float) -> Finding:
    """Test that two samples have the same expectation."""
    effect = a.mean - b.mean
    parts = a.variance / a.n, b.variance / b.n
    stderr = math.sqrt(sum(parts))
    reach = normal_quantile(0.5 * MISS) * stderr
    interval = Interval(effect - reach, effect + reach, 1 - MISS)
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
    else:
        third = a.skewness * a.variance**1.5 / a.n**2 - b.skewness * b.variance**1.5 / b.n**2
        growth = abs(third) / stderr**3 / 3
        needed = normal_quantile(alpha / 2)
        if growth * needed**3 > LARGEST_CORRECTION or max(a.largest_share, b.largest_share) > LARGEST_SHARE:
            message += "; too skewed for a test at this alpha: ask for more samples"
            return Finding(
                name, "inconclusive", message, None, alpha, effect=effect, resolution=resolution, interval=interval
            )
        freedom = stderr**4 / (parts[0] ** 2 / (a.n - 1) + parts[1] ** 2 / (b.n - 1))
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
