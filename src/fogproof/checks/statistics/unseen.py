"""Events that a sample has not met: what they would have to be to explain a mean, and what declared bounds leave them to bring."""

from __future__ import annotations

import math

from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.moments import Moments

SHARE = 0.01
"""Share of alpha for events that are likelier than allowed for, and yet were not met."""


def unseen(data: Moments, effect: float, error: float, alpha: float, known: Known) -> str:
    """Return in words what an event that was never seen would have to be, to explain the effect; "" if none can."""
    size = unseen_size(data, effect, error, alpha)
    rarest = math.log(1 / alpha) / data.n
    if rarest >= 1 or not known.low <= data.mean + size <= known.high:
        return ""
    return (
        f"; an event unseen in {data.n} (probability below {rarest:.1g}) would have to bring {size:+.2g} to explain it"
    )


def unseen_size(data: Moments, effect: float, error: float, alpha: float) -> float:
    """Return how far from the mean an unseen event would have to lie: a likelier one would have been seen but for alpha."""
    gap = max(abs(effect) - error, 0.0)
    return math.copysign(gap * (data.n / math.log(1 / alpha)), -effect)


def rarest(n: int, alpha: float) -> float:
    """Return how likely values can be that all n realisations missed, but for the probability alpha: (1 - q)^n <= exp(-n q)."""
    return min(math.log(1 / alpha) / n, 1.0)


def allowances(data: Moments, known: Known, alpha: float) -> tuple[float, float]:
    """Return by how much events beyond all that was seen may lower and raise the mean, within declared bounds.

    A side without a bound is not allowed for: nothing could be said about any mean. Where a variance is declared, what is missing
    shows in the sample's.
    """
    if known.assumed or known.variance is not None:
        return 0.0, 0.0
    rare = rarest(data.n, SHARE * alpha)
    below, above = data.low - known.low, known.high - data.high
    return tuple(rare * max(room, 0.0) if math.isfinite(room) else 0.0 for room in (below, above))  # type: ignore[return-value]
