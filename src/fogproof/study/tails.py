"""The tails of realisations: what the largest deviations say of those that were not met."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fogproof.checks.statistics.heavy import TailEstimate
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.two_values import two_valued
from fogproof.study.aggregate import Level
from fogproof.study.convergence import Z

_SUSPICIOUS = 0.05
"""Share of one realisation in the sum of squares that is worth a warning, where it is twice that of a normal law's largest."""


def tail_of(levels: Sequence[Level], data: Moments, value: float) -> TailEstimate:
    """Return the tail of the deviations from the value."""
    largest = _complete(levels)
    # Hill's estimate takes a thousandth of the sample; where fewer deviations are known, it looks further out.
    return TailEstimate(value, largest, min(data.n, 1000 * (len(largest) - 1)))


def heavy_tail(levels: Sequence[Level], data: Moments, value: float) -> str:
    """Return a warning where the variance may be infinite, or hangs on a single realisation; "" elsewhere."""
    tail = tail_of(levels, data, value)
    index, spread = tail.index()
    if tail.suspect():
        return f"infinite variance suspected: the tail has index {index:.2g} +- {spread:.1g}, where 2 is the least"
    if data.largest_share > max(
        _SUSPICIOUS, 4 * math.log(max(data.n, 2)) / data.n
    ):  # of n normal ones: about 2 ln(n) / n
        return f"heavy tail: one realisation of {data.n} has {data.largest_share:.0%} of the variance"
    return ""


def _complete(levels: Sequence[Level]) -> np.ndarray:
    """Return the largest deviations over all levels that are known whole."""
    known = [level.tail for level in levels if len(level.tail)]
    if len(known) < len([level for level in levels if level.count * level.replicates >= 64]):
        return np.empty(0)
    together = np.sort(np.concatenate(known)) if known else np.empty(0)
    least = max((tail[0] for tail in known), default=0.0)
    return together[together >= least]


def beyond(levels: Sequence[Level], data: Moments, value: float) -> float:
    """Return how much, as a logarithm, values too rare to be met may add to the variance; inf where nothing bounds it.

    Deviations beyond the largest are taken to grow rare like the power -a, a being as small as Hill's (1975) estimate allows. Above
    M, where one of n is expected, lies M^2 / n a / (a - 2) of the variance.
    """
    if two_valued(data) or not data.m2 > 0:
        return 0.0
    tail = tail_of(levels, data, value)
    index, error = tail.outermost()
    if index == math.inf:
        return 0.0
    least = index - Z * error
    if least <= 2:
        return math.inf
    k = round((index / error) ** 2)
    top = np.sort(tail.largest)[::-1]
    end = max(float(top[0]), float(top[k]) * k ** (1 / least))
    return math.log1p(end**2 / data.n * least / (least - 2) / data.variance)
