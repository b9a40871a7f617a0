"""How long an estimator takes to an error: read off the measured curve of error against time, fixed cost and bias included.

The error of independent samples without bias is known at every count, sqrt(variance / count), and goes on like that; its time
beyond the last count is told where the counts tell it (`growth`). The error of Sobol points, of marching and of what is biased is
taken between the counts that were measured, by a power law, and nowhere else.

A bias too small to be seen is part of the error too. Where it may be as large as the error asked for, the time has no upper end;
nor has it where values too rare to be met may hold more of the variance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from fogproof.study.convergence import CONFIDENCE, Estimate, Z, deviations
from fogproof.study.growth import least_beyond, power_at, time_at, time_beyond
from fogproof.study.speed import Times, scaled

TARGETS = (0.01, 0.001, 0.0001)
"""Relative root mean square errors whose time is told."""
How = Literal["measured", "less-than", "extrapolated", "not-reached", "rises", "never"]
Unless = Literal["", "bias", "rare"]


@dataclass(frozen=True, eq=False)
class ErrorOverTime:
    """Error against time of one estimator.

    counts    (levels,) samples or steps, rising
    errors    RMSE at each, bias included, in the unit of the quantity; intervals of no width where nothing is random
    stays     what no number of samples or steps takes away: a bias that was shown, rounding
    smooth    whether nothing is random: then an error may be small by a lucky crossing, and grow again
    ends      whether more samples were asked for and could not be drawn
    bias      the largest that there may be, where the law takes it to be 0, or all values are alike
    rare      whether values that were not met may hold more of the error
    times     of one estimate at each
    law       the variance of one realisation with its interval where the error is sqrt(variance / count); None elsewhere
    """

    counts: np.ndarray
    errors: Sequence[Estimate]
    times: Sequence[Times]
    law: Estimate | None = None
    stays: float = 0.0
    smooth: bool = False
    ends: bool = False
    bias: float = 0.0
    rare: bool = False

    def nearer(self) -> int | None:
        """Return the largest count that was surely nearer than the last, where the error grows to the last; None elsewhere."""
        *before, last = self.errors
        near = [int(n) for n, e in zip(self.counts, before, strict=False) if e.high < last.low]
        falls = bool(before) and last.high < before[-1].low
        return near[-1] if near and not falls and not self.smooth else None


@dataclass(frozen=True, eq=False)
class Reach:
    """The time to an error.

    error    relative to the reference
    how      "measured", between two counts; "less-than": the first count is better already, and its time is told;
             "extrapolated" beyond the last; "not-reached" by the last, whose time is told, or beyond it in a time that the counts
             do not tell; "rises" where fewer samples were surely nearer, and the last are not near enough; "never"
    why      of what was not reached, in words
    samples  or steps; None if not reached
    times    of one estimate with so many; at the last count, where that does not reach it
    untimed  whether so many samples are known to do, and their time alone is not known
    noise    how far the logarithm of the time reaches below and above because of the error's own interval
    least    what is known to be needed in any case: the time of a larger error, or of so many samples
    call     the time of the first count where that is not enough, None elsewhere: no estimate that is takes less
    unless   what leaves the time without an upper end: "bias", one that may be as large as the error and was too small to be seen;
             "rare", values that were not met; "" where nothing does
    """

    error: float
    how: How
    why: str
    samples: float | None
    times: Times
    noise: tuple[float, float] = (0.0, 0.0)
    untimed: bool = False
    least: float = 0.0
    call: Times | None = None
    unless: Unless = ""

    @property
    def reached(self) -> bool:
        """Whether a time is known."""
        return self.how not in ("not-reached", "rises", "never")

    @property
    def seconds(self) -> Estimate:
        """The time with its interval, which begins at 0 where the first count is better already, and may have no end."""
        own = self.times.estimate
        time = scaled(own.value, *_wider(own, self.noise))
        least = max(self.least, self.call.estimate.low) if self.call else self.least
        low = 0.0 if self.how == "less-than" else max(time.low, min(least, own.value))
        return Estimate(own.value, low, math.inf if self.unless else time.high)

    @property
    def at_least(self) -> float:
        """The least time that the error may take."""
        return self.seconds.low if self.reached else max(self.times.estimate.value, self.least)

    def after(self, larger: Reach) -> Reach:
        """Return the same where a larger error takes so much: a smaller one takes no less, nor may it."""
        sooner = self.reached and larger.reached and self.times.estimate.value < larger.times.estimate.value
        return replace(self, times=larger.times if sooner else self.times, least=max(self.least, larger.at_least))

    def relative_to(self, other: Reach, confidence: float = CONFIDENCE) -> Estimate | None:
        """Return how many times as long it takes as another does; None where either is not known.

        Two of which neither may be biased by so much are compared as if neither were.
        """
        if not (self.reached and other.reached):
            return None
        ratio, more = self.times.relative_to(other.times, confidence), deviations(confidence) / Z
        noise = math.hypot(self.noise[0], other.noise[1]), math.hypot(self.noise[1], other.noise[0])
        below, above = _wider(ratio, (more * noise[0], more * noise[1]))
        if self.how == "less-than" or other._endless_beside(self):
            below = math.inf
        if other.how == "less-than" or self._endless_beside(other):
            above = math.inf
        found = scaled(ratio.value, below, above)
        least = max(found.low, 1 / other._most(self, confidence))
        return Estimate(
            found.value, min(least, found.value), max(min(found.high, self._most(other, confidence)), found.value)
        )

    def _endless_beside(self, other: Reach) -> bool:
        """Return whether the time has no upper end when compared with another's."""
        return self.unless == "rare" or (self.unless == "bias" and other.unless != "bias")

    def _most(self, other: Reach, confidence: float) -> float:
        """Return how many times as long as the call of another that is not enough it takes at most: the other takes no less."""
        if other.call is None or self._endless_beside(other):
            return math.inf
        ratio = self.times.relative_to(other.call, confidence)
        _, above = _wider(ratio, (0.0, deviations(confidence) / Z * self.noise[1]))
        return scaled(ratio.value, 0.0, above).high


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
    unless: Unless = "rare" if curve.rare or curve.bias >= target else ""
    size = np.array([e.value for e in curve.errors])
    how: How
    first = len(size)
    while first > 0 and size[first - 1] <= target:
        first -= 1
    if first == len(size):
        said = f"{int(curve.counts[-1])} leave {size[-1] / target * error:.2g}"
        nearer = curve.nearer()
        if nearer is not None and curve.errors[-1].low > target:
            return Reach(error, "rises", f"{said}, {nearer} are nearer", None, curve.times[-1])
        how = "never" if curve.stays > target else "not-reached"
        return Reach(error, how, said, None, curve.times[-1])
    if first == 0:
        above = _noise(curve, 0, 1, 0.0)[1] if len(size) > 1 and curve.errors[0].high > target else 0.0
        how = "less-than" if curve.counts[0] > 1 else "measured"  # there is nothing less than one
        return Reach(error, how, "", float(curve.counts[0]), curve.times[0], (0.0, above), unless=unless)
    before, after = size[first - 1], max(size[first], 1e-300)
    share = math.log(before / target) / math.log(before / after)
    at = float(curve.counts[first - 1] * (curve.counts[first] / curve.counts[first - 1]) ** share)
    when = time_at(curve.counts, curve.times, at)
    below, above = _noise(curve, first - 1, first, share)
    noise = math.hypot(below, when.bend[0]), math.hypot(above, when.bend[1])
    return Reach(error, "measured", "", at, when.times, noise, unless=unless)


def _noise(curve: ErrorOverTime, a: int, b: int, share: float) -> tuple[float, float]:
    """Return how far the errors' intervals reach in the logarithm of the time, `share` of the way from one count to another.

    Between them the error falls like a power of the count; one that is larger than measured needs more, and the time of those.
    """
    one, two = curve.errors[a], curve.errors[b]
    if not 0 < two.value < one.value:
        return math.inf, math.inf
    count = curve.counts[a] * (curve.counts[b] / curve.counts[a]) ** share
    needs = (
        math.log(curve.counts[b] / curve.counts[a])
        / math.log(one.value / two.value)
        * power_at(curve.counts, curve.times, count)
    )
    reaches = [(math.log(e.value / e.low) if e.low > 0 else math.inf, math.log(e.high / e.value)) for e in (one, two)]
    below, above = (a if share == 0 else (1 - share) * a + share * b for a, b in zip(*reaches, strict=True))
    return (needs * below, needs * above) if needs else (0.0, 0.0)


def _by_the_law(curve: ErrorOverTime, law: Estimate, target: float, error: float, hidden: float) -> Reach:
    needed, unsure = law.value / target**2, 2 * hidden / target
    left = 1 - (curve.bias / target) ** 2  # of the square of the error, were there such a bias
    unless: Unless = "rare" if curve.rare or law.high == math.inf else "bias" if left <= 0 else ""
    more = (
        math.inf
        if unless == "rare"
        else math.log(law.high / law.value) + unsure - (math.log(left) if left > 0 else 0.0)
    )
    if needed <= curve.counts[0]:
        grows = power_at(curve.counts, curve.times, float(curve.counts[0]))
        above = grows * max(0.0, math.log(needed / curve.counts[0]) + more) if more < math.inf else math.inf
        return Reach(error, "less-than", "", float(curve.counts[0]), curve.times[0], (0.0, above), unless=unless)
    beyond = needed > curve.counts[-1]
    if beyond and curve.ends:
        return Reach(error, "not-reached", "larger counts could not be drawn", None, curve.times[-1])
    at = (time_beyond if beyond else time_at)(curve.counts, curve.times, needed)
    if isinstance(at, str):
        least = least_beyond(curve.counts, curve.times, max(law.low / target**2 * math.exp(-unsure), curve.counts[-1]))
        return Reach(error, "not-reached", at, None, curve.times[-1], untimed=True, least=least)
    grows = power_at(curve.counts, curve.times, needed)
    below = grows * (math.log(law.value / law.low) + unsure) if law.low > 0 else math.inf
    above = grows * more if more < math.inf else math.inf
    noise = math.hypot(below, at.bend[0]), math.hypot(above, at.bend[1])
    return Reach(error, "extrapolated" if beyond else "measured", "", needed, at.times, noise, unless=unless)


def variance_law(value: float, spread: float, beyond: float, exact: bool) -> Estimate:
    """Return a variance with its interval; `spread` is the standard error of its logarithm, `beyond` what rare values may add."""
    reach = 0.0 if exact else Z * spread
    return scaled(value, reach, reach if exact else reach + beyond)
