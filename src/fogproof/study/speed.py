"""Speed: the time of a realisation, efficiency, and the time to reach an error. Everything here depends on the machine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fogproof.study.aggregate import Level
from fogproof.study.cells import Cell
from fogproof.study.convergence import Estimate, Z

TARGETS = (0.01, 0.001, 0.0001)
"""Relative errors, one standard error or bias, whose time is told."""


@dataclass(frozen=True)
class Target:
    """How much an error costs; samples and seconds are None where no number of samples is enough.

    how  "computed" from the variance, "measured" between two counts, "extrapolated" beyond the last, or why it is never reached
    """

    error: float
    samples: float | None
    seconds: float | None
    how: str


def time_of(level: Level) -> Estimate:
    """Return the processor time of a realisation [s]: the median over the batches, with its interval by order statistics."""
    times = np.sort(level.cpu)
    n = len(times)
    reach = 0.5 * Z * math.sqrt(n)
    low, high = max(int(0.5 * n - reach), 0), min(math.ceil(0.5 * n + reach), n - 1)
    return Estimate(float(np.median(times)), float(times[low]), float(times[high]))


def spread_of(time: Estimate) -> float:
    """Return the standard error of the logarithm of a time."""
    return math.log(time.high / time.low) / (2 * Z) if 0 < time.low < time.high else 0.0


@dataclass(frozen=True)
class Efficiency:
    """1 / (mean squared error x time) [1/s in units of the quantity squared]; infinite for what is exact.

    spread  standard error of its logarithm
    """

    value: float
    spread: float

    def relative_to(self, best: Efficiency) -> Estimate:
        """Return the ratio to another one, and its interval."""
        if math.isinf(self.value) or math.isinf(best.value):
            ratio = 1.0 if self.value == best.value else math.inf if math.isinf(self.value) else 0.0
            return Estimate(ratio, ratio, ratio)
        ratio = self.value / best.value
        reach = math.exp(min(Z * math.hypot(self.spread, best.spread), 700.0)) if self is not best else 1.0
        return Estimate(ratio, ratio / reach, ratio * reach)


def targets_of(
    cell: Cell, levels: Sequence[Level], variance: float, bias: float, rmse: Sequence[float]
) -> list[Target]:
    """Return what each of `TARGETS` costs.

    variance  of one realisation
    bias      0 unless the estimator was rejected
    rmse      at each level
    """
    value = abs(float(cell.reference.value))
    if value == 0:
        return [Target(error, None, None, "the reference is 0") for error in TARGETS]
    marched = cell.method.axis == "steps"
    if marched or cell.points == "sobol":
        counts = [level.count for level in levels]
        seconds = [time_of(level).value * (1 if marched else level.count) for level in levels]
        return [_on_the_curve(error, error * value, counts, seconds, rmse, marched) for error in TARGETS]
    found = []
    for error in TARGETS:
        left = (error * value) ** 2 - bias**2
        if left <= 0:
            found.append(Target(error, None, None, f"the bias of {bias / value:.2g} stays"))
        else:
            samples = max(variance / left, 1.0)
            found.append(Target(error, samples, samples * time_of(levels[-1]).value, "computed"))
    return found


_BEYOND = math.log(1e18)
"""What grows by more than this is beyond any number of samples, and soon beyond any number."""


def _on_the_curve(
    error: float, target: float, counts: list[int], seconds: list[float], size: Sequence[float], marched: bool
) -> Target:
    """Return where the measured error passes the target for good, by the power law between two counts.

    Beyond the last count a march may have met its floor, and nothing is said; the error of Sobol points goes on falling.
    """
    first = len(size)
    while first > 0 and size[first - 1] <= target:
        first -= 1
    if first == 0:
        return Target(error, float(counts[0]), seconds[0], "measured")
    if first < len(size):
        k, how = first, "measured"
    elif marched:
        return Target(error, None, None, f"{counts[-1]} steps are not enough")
    elif len(size) < 2 or not size[-1] < size[-2]:
        return Target(error, None, None, "the error does not fall")
    else:
        k, how = len(size) - 1, "extrapolated"
    share = math.log(size[k - 1] / target) / math.log(size[k - 1] / max(size[k], 1e-300))
    if share * math.log(counts[k] / counts[k - 1]) > _BEYOND:
        return Target(error, None, None, "the error hardly falls")
    samples = counts[k - 1] * (counts[k] / counts[k - 1]) ** share
    return Target(error, samples, seconds[k - 1] * (seconds[k] / seconds[k - 1]) ** share, how)
