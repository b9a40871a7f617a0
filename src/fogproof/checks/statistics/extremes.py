"""Tests of a mean from the extremes and the mean alone: they hold for every n and every law that keeps what is declared.

All realisations at or below c, and the claimed mean m above: of a law that never exceeds h at most (h - m) / (h - c) lies there
(Markov), of a law with variance v at most v / (v + (m - c)^2) (Cantelli 1928). So much to the power n is the p-value of the largest
realisation, and a black pixel is no longer a riddle. A bounded mean itself is held to Chernoff's bound in the form of Hoeffding
(1963, theorem 1): exp(-n kl(mean, m)).
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
        p = 2 * min(p, 2 * _chernoff(data.n, mean, *claims))
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


def _kl(a: float, b: float) -> float:
    a = min(max(a, 0.0), 1.0)
    one = a * math.log(a / b) if a > 0 else 0.0
    return one + ((1 - a) * math.log((1 - a) / (1 - b)) if a < 1 else 0.0)


def detectable(n: int, known: Known, alpha: float, miss: float) -> float:
    """Return the bias that `extremes_p` finds but for the probability `miss`: Hoeffding's inequality, twice; inf if none."""
    if not known.bounded:
        return math.inf
    reach = math.sqrt(math.log(4 / alpha) / (2 * n)) + math.sqrt(math.log(1 / miss) / (2 * n))
    return min((known.high - known.low) * reach, known.high - known.low)
