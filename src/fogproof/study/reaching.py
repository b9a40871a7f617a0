"""How long an estimator takes to an error: read off the measured curve of error against time, fixed cost and bias included.

The error of independent samples without bias is known at every count, sqrt(variance / count), and goes on like that. That of Sobol
points, of marching and of what is biased is taken between the counts that were measured, by a power law, and nowhere else.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fogproof.study.convergence import Estimate, Z
from fogproof.study.speed import Times, scaled

TARGETS = (0.01, 0.001, 0.0001)
"""Relative root mean square errors whose time is told."""
How = Literal["measured", "less-than", "extrapolated", "not-reached", "never"]


@dataclass(frozen=True, eq=False)
class ErrorOverTime:
    """Error against time of one estimator.

    counts    (levels,) samples or steps, rising
    errors    RMSE at each, bias included, in the unit of the quantity; intervals of no width where nothing is random
    stays     what no number of samples or steps takes away: a bias that was shown, rounding
    times     of one estimate at each
    law       the variance of one realisation with its interval where the error is sqrt(variance / count); None elsewhere
    """

    counts: np.ndarray
    errors: Sequence[Estimate]
    times: Sequence[Times]
    law: Estimate | None = None
    stays: float = 0.0


@dataclass(frozen=True, eq=False)
class Reach:
    """The time to an error.

    error    relative to the reference
    how      "measured", between two counts; "less-than": the first count is better already, and its time is told;
             "extrapolated" beyond the last; "not-reached" by the last, whose time is told; "never"
    why      of what was not reached, in words
    samples  or steps; None if not reached
    times    of one estimate with so many; at the last count, where that does not reach it
    noise    how far the logarithm of the time reaches below and above because of the error's own interval
    """

    error: float
    how: How
    why: str
    samples: float | None
    times: Times
    noise: tuple[float, float] = (0.0, 0.0)

    @property
    def reached(self) -> bool:
        """Whether a time is known."""
        return self.how not in ("not-reached", "never")

    @property
    def seconds(self) -> Estimate:
        """The time with its interval, which begins at 0 where the first count is better already."""
        own = self.times.estimate
        if self.how == "less-than":
            return Estimate(own.value, 0.0, scaled(own.value, *_wider(own, self.noise)).high)
        return scaled(own.value, *_wider(own, self.noise))

    def relative_to(self, other: Reach) -> Estimate | None:
        """Return how many times as long it takes as another does; None where either is not known."""
        if not (self.reached and other.reached):
            return None
        ratio = self.times.relative_to(other.times)
        below, above = _wider(
            ratio, (math.hypot(self.noise[0], other.noise[1]), math.hypot(self.noise[1], other.noise[0]))
        )
        below = math.inf if self.how == "less-than" else below
        above = math.inf if other.how == "less-than" else above
        return scaled(ratio.value, below, above)


def _wider(time: Estimate, noise: tuple[float, float]) -> tuple[float, float]:
    below = math.log(time.value / time.low) if time.low > 0 else math.inf
    above = math.log(time.high / time.value) if time.high < math.inf else math.inf
    return math.hypot(below, noise[0]), math.hypot(above, noise[1])


def reach_of(curve: ErrorOverTime, target: float, error: float, hidden: float = 0.0) -> Reach:
    """Return when a curve reaches the error `target`, in the unit of the quantity; `error` is the same relative to the reference.

    hidden  what the reference may be off
    """
    if curve.law is not None:
        return _by_the_law(curve, curve.law, target, error, hidden)
    size = np.array([e.value for e in curve.errors])
    how: How
    first = len(size)
    while first > 0 and size[first - 1] <= target:
        first -= 1
    if first == len(size):
        how = "never" if curve.stays > target else "not-reached"
        return Reach(
            error, how, f"{int(curve.counts[-1])} leave {size[-1] / target * error:.2g}", None, curve.times[-1]
        )
    if first == 0:
        above = _noise(curve, 0, 1, 0.0)[1] if len(size) > 1 and curve.errors[0].high > target else 0.0
        how = "less-than" if curve.counts[0] > 1 else "measured"  # there is nothing less than one
        return Reach(error, how, "", float(curve.counts[0]), curve.times[0], (0.0, above))
    before, after = size[first - 1], max(size[first], 1e-300)
    share = math.log(before / target) / math.log(before / after)
    at = float(curve.counts[first - 1] * (curve.counts[first] / curve.counts[first - 1]) ** share)
    return Reach(error, "measured", "", at, _times_at(curve, at), _noise(curve, first - 1, first, share))


def _noise(curve: ErrorOverTime, a: int, b: int, share: float) -> tuple[float, float]:
    """Return how far the errors' intervals reach in the logarithm of the time, `share` of the way from one count to another.

    Between them the error falls like a power of the count; one that is larger than measured needs more, and the time of those.
    """
    one, two = curve.errors[a], curve.errors[b]
    if not 0 < two.value < one.value:
        return math.inf, math.inf
    count = curve.counts[a] * (curve.counts[b] / curve.counts[a]) ** share
    needs = math.log(curve.counts[b] / curve.counts[a]) / math.log(one.value / two.value) * _growth(curve, count)
    reaches = [(math.log(e.value / e.low) if e.low > 0 else math.inf, math.log(e.high / e.value)) for e in (one, two)]
    below, above = (a if share == 0 else (1 - share) * a + share * b for a, b in zip(*reaches, strict=True))
    return (needs * below, needs * above) if needs else (0.0, 0.0)


def _by_the_law(curve: ErrorOverTime, law: Estimate, target: float, error: float, hidden: float) -> Reach:
    needed = law.value / target**2
    if needed <= curve.counts[0]:
        return Reach(error, "less-than", "", float(curve.counts[0]), curve.times[0])
    how: How = "measured" if needed <= curve.counts[-1] else "extrapolated"
    times = _times_at(curve, needed)
    unsure = 2 * hidden / target
    grows = _growth(curve, needed)
    below = grows * (math.log(law.value / law.low) + unsure) if law.low > 0 else math.inf
    above = grows * (math.log(law.high / law.value) + unsure)
    return Reach(error, how, "", needed, times, (below, above))


def _growth(curve: ErrorOverTime, count: float) -> float:
    """Return the power with which the time grows around a count."""
    a, b = (_times_at(curve, count * factor).estimate.value for factor in (0.99, 1.01))
    return max(math.log(b / a) / math.log(1.01 / 0.99), 0.0) if a > 0 and b > 0 else 1.0


def _times_at(curve: ErrorOverTime, count: float) -> Times:
    """Return the time of an estimate at a count: a fixed cost and so much a sample, between two counts and beyond the last."""
    counts = curve.counts
    if len(counts) == 1 or count in (counts[0], counts[-1]):
        k = 0 if count == counts[0] else -1
        return Times(curve.times[k].seconds * (count / counts[k]))
    k = min(max(int(np.searchsorted(counts, count, side="right")), 1), len(counts) - 1)
    a, b = curve.times[k - 1].seconds, curve.times[k].seconds
    if len(a) != len(b):
        a, b = (np.array([Times(s).estimate.value]) for s in (a, b))
    each = (b - a) / (counts[k] - counts[k - 1])
    if count > counts[k]:
        each = np.where(each > 0, each, b / counts[k])  # noise: nothing gets faster by more samples
    return Times(b + (count - counts[k]) * each)


def variance_law(value: float, spread: float, exact: bool) -> Estimate:
    """Return a variance with its interval; spread is the standard error of its logarithm."""
    reach = 0.0 if exact else Z * spread
    return scaled(value, reach, reach)
