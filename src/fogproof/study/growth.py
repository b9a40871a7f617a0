"""How the time of a call grows with its samples: between the counts that were measured, and beyond the last as far as they tell.

A call costs something once and so much a sample. Where three counts show that it does not, a power of the count takes the place of
the count itself, and what a line would say stays inside the interval. Beyond the last count a time that is not known to a factor
`BLUR` is none, nor one of which line and power say something else by more than that. There a slight bend, such as that of a cache
that is full, is taken for passing: the line is told, and what the power would say stays inside the interval.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fogproof.study.convergence import CONFIDENCE
from fogproof.study.speed import Times

BLUR = 10.0
_SLIGHT = (0.75, 1.6)
"""Powers that are taken for a line with a step in it."""
_POWERS = (0.1, 6.0)
"""Between which powers of the count a time may grow."""


@dataclass(frozen=True, eq=False)
class TimeAt:
    """The time of an estimate at a count, and how far its logarithm reaches below and above for want of a law."""

    times: Times
    bend: tuple[float, float] = (0.0, 0.0)


def time_at(counts: np.ndarray, times: Sequence[Times], count: float) -> TimeAt:
    """Return the time at a count that is no smaller than the first and no larger than the last."""
    k = min(max(int(np.searchsorted(counts, count)), 1), len(counts) - 1)
    for end in (0, k):
        if count == counts[end]:
            return TimeAt(times[end])
    a, b = _same_rounds(times[k - 1], times[k])
    ends = Times(a).estimate.value, Times(b).estimate.value
    power = _power(counts, times, k)
    found, line = (_within(Times(a + _share(counts, k, count, p) * (b - a)), *ends) for p in (power, 1.0))
    return TimeAt(found, _bend(found, line))


def time_beyond(counts: np.ndarray, times: Sequence[Times], count: float) -> TimeAt | str:
    """Return the time at a count beyond the last, or in words why these counts do not tell it."""
    if len(counts) == 1:
        return "one count says nothing of the time of more: add a larger one to `samples`"
    k = len(counts) - 1
    a, b = _same_rounds(times[k - 1], times[k])
    last = times[k].estimate.value
    power = _power(counts, times, k)
    found, other = (b + (_share(counts, k, count, p) - 1) * (b - a) for p in (power, 1.0))
    if _SLIGHT[0] < power < _SLIGHT[1]:
        found, other = other, found
    if np.any(b <= a):  # a round in which more samples took less time: noise is as large as what they take
        least, most = _interval(found)
        least, found, other = max(least, last), np.maximum(found, last), np.maximum(other, last)
    else:
        least, most = Times(found).estimate.low, Times(found).estimate.high
    bend = _bend(Times(found), Times(other))
    if most > BLUR * least:
        return "the samples took too little time beside the call itself: add a larger count to `samples`"
    if max(bend) > math.log(BLUR):
        return "the time does not grow like a fixed cost and so much a sample: add a larger count to `samples`"
    return TimeAt(Times(found), bend)


def least_beyond(counts: np.ndarray, times: Sequence[Times], count: float) -> float:
    """Return what a count beyond the last takes at least: no further sample is cheaper than those from the first count to the last.

    Where the time was shown to grow by a lesser power of the count, it goes on like that.
    """
    k = len(counts) - 1
    last = times[k].estimate.value
    if k == 0:
        return last
    a, b = _same_rounds(times[0], times[k])
    power = min(_power(counts, times, k), 1.0)
    low, high = (float(counts[i]) ** power for i in (0, k))
    least, _ = _interval(b + (count**power - high) / (high - low) * (b - a))
    return max(least, last)


def power_at(counts: np.ndarray, times: Sequence[Times], count: float) -> float:
    """Return the power of the count with which the time grows around a count, 0 at least."""
    if len(counts) == 1:
        return 1.0
    k = min(max(int(np.searchsorted(counts, count)), 1), len(counts) - 1)
    a, b = times[k - 1].estimate.value, times[k].estimate.value
    power = _power(counts, times, k)
    here, near = (float(a + _share(counts, k, count * factor, power) * (b - a)) for factor in (0.99, 1.01))
    return max(math.log(near / here) / math.log(1.01 / 0.99), 0.0) if here > 0 and near > 0 else 1.0


def _share(counts: np.ndarray, k: int, count: float, power: float) -> float:
    """Return how far a count lies on the way from the count k - 1 to the count k, in powers."""
    low, high = (float(counts[i]) ** power for i in (k - 1, k))
    return float((count**power - low) / (high - low))


def _power(counts: np.ndarray, times: Sequence[Times], k: int) -> float:
    """Return p where the times at three counts, k - 1 and k among them, are A + B count^p; 1 unless a line is shown not to fit."""
    from scipy.optimize import brentq

    if len(counts) < 3:
        return 1.0
    first_of_three = min(k - 1, len(counts) - 3)
    rows = [t.seconds for t in times[first_of_three : first_of_three + 3]]
    if len({len(row) for row in rows}) > 1:
        return 1.0
    n = counts[first_of_three : first_of_three + 3].astype(float)
    first, second = (rows[1] - rows[0]) / (n[1] - n[0]), (rows[2] - rows[1]) / (n[2] - n[1])
    low, high = _interval((second - first) / Times(rows[2]).estimate.value)
    if not (low > 0 or high < 0):
        return 1.0
    t = [Times(row).estimate.value for row in rows]
    rise = (t[1] - t[0]) * (n[2] - n[1]) / ((n[1] - n[0]) * max(t[2] - t[1], 1e-300))

    def off(p: float) -> float:  # how much steeper the later stretch is than a power makes it
        m = (n / n[2]) ** p
        return float((m[1] - m[0]) * (n[2] - n[1]) / ((n[1] - n[0]) * (m[2] - m[1])) - rise)

    least, most = _POWERS
    if off(least) <= 0 or off(most) >= 0:
        return least if off(least) <= 0 else most
    return float(brentq(off, least, most))


def _same_rounds(one: Times, other: Times) -> tuple[np.ndarray, np.ndarray]:
    a, b = one.seconds, other.seconds
    return (a, b) if len(a) == len(b) else (np.array([one.estimate.value]), np.array([other.estimate.value]))


def _within(times: Times, low: float, high: float) -> Times:
    """Return the times moved together, if they must be, so that their mean lies between those of the counts around."""
    value = times.estimate.value
    return Times(times.seconds * (min(max(value, low), high) / value))


def _bend(found: Times, other: Times) -> tuple[float, float]:
    off = math.log(other.estimate.value / found.estimate.value)
    return max(-off, 0.0), max(off, 0.0)


def _interval(values: np.ndarray) -> tuple[float, float]:
    """Return Student's interval of a mean; without end where a single value says nothing of it."""
    from scipy.special import stdtrit

    values = values[np.isfinite(values)]
    if len(values) < 2:
        return -math.inf, math.inf
    mean = float(values.mean())
    reach = float(stdtrit(len(values) - 1, (1 + CONFIDENCE) / 2)) * float(values.std(ddof=1)) / math.sqrt(len(values))
    return mean - reach, mean + reach
