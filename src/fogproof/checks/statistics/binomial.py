"""The exact binomial test of a probability, and the smallest error that it finds."""

from __future__ import annotations

from collections.abc import Callable

from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.tails import (
    binomial_at_least,
    binomial_at_most,
    binomial_interval,
)
from fogproof.checks.verdict import EffectInterval, Finding, Resolution


def binomial(name: str, what: str, count: int, n: int, low: float, high: float, cause: str, alpha: float) -> Finding:
    """Exact two-sided binomial test that a probability lies in [low, high] (a point, or known to within an error)."""
    p = binomial_p(count, n, low, high)
    share = count / n
    centre = 0.5 * (low + high)
    resolution = Resolution(f"error of {what}", binomial_resolution(n, low, high, alpha), MISS)
    message = f"{what} is {centre:.6g}, observed {share:.6g} ({count} of {n})"
    rejected = p <= alpha
    ends = binomial_interval(count, n, MISS)
    return Finding(
        name,
        "rejected" if rejected else "not rejected",
        message,
        p,
        alpha,
        False,
        share,
        share - centre,
        resolution,
        interval=EffectInterval(ends[0] - centre, ends[1] - centre, 1 - MISS),
        cause=cause if rejected else "",
    )


def binomial_resolution(n: int, low: float, high: float, alpha: float) -> float:
    """Return by how much a probability must differ from the middle of [low, high] to be rejected, but for `MISS`: exact.

    The least count above and the greatest below that are rejected are searched, and the probabilities that reach them.
    """
    from scipy.special import betaincinv

    centre = 0.5 * (low + high)
    least = _first(lambda k: binomial_at_least(k, n, min(high, 1.0)) <= alpha / 2, 0, n + 1)
    most = _first(lambda k: binomial_at_most(k, n, max(low, 0.0)) > alpha / 2, 0, n + 1) - 1
    up = float(betaincinv(least, n - least + 1, 1 - MISS)) - centre if least <= n else 0.0
    down = centre - float(betaincinv(most + 1, n - most, MISS)) if most >= 0 else 0.0
    return max(up, down) if max(up, down) > 0 else 1.0


def _first(good: Callable[[int], bool], low: int, high: int) -> int:
    """Return the first whole number in [low, high) from which on `good` holds, `high` if there is none."""
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if good(middle) else (middle + 1, high)
    return low


def binomial_p(count: int, n: int, low: float, high: float) -> float:
    """Return the two-sided p-value (twice the smaller tail) of `count` under the kindest probability in [low, high]."""
    low, high = min(max(low, 0.0), 1.0), min(max(high, 0.0), 1.0)
    below = binomial_at_most(count, n, low)  # largest at the smallest probability
    above = binomial_at_least(count, n, high)
    return min(1.0, 2 * min(below, above))
