"""Tests of a mean from the extremes and the mean alone: they hold for every n and every law that keeps what is declared.

All realisations at or below c, and the claimed mean m above: of a law that never exceeds h at most (h - m) / (h - c) lies there
(Markov), of a law with variance v at most v / (v + (m - c)^2) (Cantelli 1928). So much to the power n is the p-value of the largest
realisation, and a black pixel is no longer a riddle. A bounded mean itself is held to Chernoff's bound in the form of Hoeffding
(1963, theorem 1): exp(-n kl(mean, m)); where the variance v is known too, to Bennett's (1962): exp(-n v / b^2 h(b gap / v)) with
h(u) = (1 + u) log(1 + u) - u, b being the room between m and the bound.
"""

from __future__ import annotations

import math

from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.moments import Moments


def extremes_p(data: Moments, low: float, high: float, known: Known) -> float:
    """Return a valid p-value of the claim that the expectation lies in [low, high], 1 where nothing declared helps."""
    sides = (
        _beyond(data.n, low - data.high, known.high - low, known.deviation),
        _beyond(data.n, data.low - high, high - known.low, known.deviation),
    )
    p = 2 * min(sides)
    if known.bounded:
        width = known.high - known.low
        mean = (data.mean - known.low) / width
        claims = ((low - known.low) / width, (high - known.low) / width)
        tail = _chernoff(data.n, mean, *claims)
        if known.variance is not None:
            above = _bennett(data.n, data.mean - high, known.high - low, known.variance)
            below = _bennett(data.n, low - data.mean, high - known.low, known.variance)
            tail = 2 * min(tail, above, below)
        p = 2 * min(p, 2 * tail)
    return min(1.0, p)


def _beyond(n: int, gap: float, room: float, deviation: float | None) -> float:
    """Return the probability of n realisations all at least `gap` from the mean on one side, with `room` on the other."""
    if not gap > 0:
        return 1.0
    log = 0.0
    if math.isfinite(room):
        log = -math.inf if room <= 0 else -math.log1p(gap / room)
    if deviation is not None:
        log = min(log, -math.inf if deviation == 0 else -2 * math.log(math.hypot(1.0, gap / deviation)))
    return math.exp(n * log) if log > -math.inf else 0.0


def _chernoff(n: int, mean: float, low: float, high: float) -> float:
    nearest = min(max(mean, low), high)
    if nearest == mean:
        return 1.0
    if not 0 < nearest < 1:
        return 0.0  # no law between the bounds has such a mean and varies
    return math.exp(-n * max(_kl(mean, nearest), 0.0))


def _bennett(n: int, gap: float, room: float, variance: float) -> float:
    """Return a bound of the probability that a mean lies `gap` beyond its expectation, on the side of `room`."""
    if not gap > 0:
        return 1.0
    if variance == 0 or room <= 0:
        return 0.0
    u = room * gap / variance
    return math.exp(-n * variance / room**2 * ((1 + u) * math.log1p(u) - u))


def _kl(a: float, b: float) -> float:
    a = min(max(a, 0.0), 1.0)
    one = a * math.log(a / b) if a > 0 else 0.0
    return one + ((1 - a) * math.log((1 - a) / (1 - b)) if a < 1 else 0.0)


def detectable(n: int, known: Known, alpha: float, miss: float) -> float:
    """Return the bias that `extremes_p` finds but for the probability `miss`; inf if none.

    Hoeffding's inequality, twice: for the test, and for the sample. Where the variance is known, Bernstein's, which is weaker than
    Bennett's; it holds for a biased law as long as that varies no more than declared.
    """
    if not known.bounded:
        return math.inf
    width, some = known.high - known.low, 8 if known.variance is not None else 4
    reaches = [width * sum(math.sqrt(log / (2 * n)) for log in (math.log(some / alpha), math.log(1 / miss))), width]
    if known.variance is not None:
        logs = (math.log(8 / alpha), math.log(1 / miss))
        reaches.append(sum(math.sqrt(2 * known.variance * log / n) + width * log / (3 * n) for log in logs))
    return min(reaches)
