"""The time of an estimate: of the call that makes it, fixed cost included, in rounds that all estimators share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fogproof.study.aggregate import Level
from fogproof.study.convergence import CONFIDENCE, Estimate


@dataclass(frozen=True, eq=False)
class Times:
    """Seconds of one estimate, (rounds,); NaN in rounds that have not been drawn.

    A round holds a share of each estimator's batches, drawn at about the same time: what the machine does meanwhile hits all alike,
    and is in the scatter of the rounds.
    """

    seconds: np.ndarray

    @property
    def estimate(self) -> Estimate:
        """The geometric mean over the rounds, with Student's interval."""
        return _around(np.log(self.seconds))

    def relative_to(self, other: Times, confidence: float = CONFIDENCE) -> Estimate:
        """Return the ratio to another's time, round by round where both have the same rounds."""
        own, others = np.log(self.seconds), np.log(other.seconds)
        if len(own) == len(others) and np.count_nonzero(np.isfinite(own - others)) > 1:
            return _around(own - others, confidence)
        a, b = _around(own, confidence), _around(others, confidence)
        reach = math.hypot(math.log(a.high / a.value), math.log(b.high / b.value))
        return scaled(a.value / b.value, reach, reach)


def scaled(value: float, below: float, above: float) -> Estimate:
    """Return an estimate whose logarithm reaches so far below and above its value."""
    return Estimate(
        value, value * math.exp(-below) if below < 700 else 0.0, value * math.exp(above) if above < 700 else math.inf
    )


def _around(logs: np.ndarray, confidence: float = CONFIDENCE) -> Estimate:
    from scipy.special import stdtrit

    logs = logs[np.isfinite(logs)]
    if len(logs) == 0:
        return Estimate(math.nan, 0.0, math.inf)
    value = math.exp(float(logs.mean()))
    if len(logs) == 1:
        return Estimate(value, 0.0, math.inf)
    reach = float(stdtrit(len(logs) - 1, (1 + confidence) / 2)) * float(logs.std(ddof=1)) / math.sqrt(len(logs))
    return scaled(value, reach, reach)


def times_of(levels: Sequence[Level]) -> list[Times]:
    """Return the time of one estimate at each count, rising: where noise makes more samples faster, counts share their mean.

    Pool adjacent violators (Ayer et al. 1955), in logarithms.
    """
    means = [math.log(Times(level.seconds).estimate.value) for level in levels]
    pools: list[list[float]] = []
    for mean in means:
        pools.append([mean])
        while len(pools) > 1 and np.mean(pools[-2]) > np.mean(pools[-1]):
            pools[-2:] = [pools[-2] + pools[-1]]
    rising = [float(np.mean(pool)) for pool in pools for _ in pool]
    return [Times(level.seconds * math.exp(new - old)) for level, new, old in zip(levels, rising, means, strict=True)]
