"""How the error falls: RMSE at each count with an interval, the slope over the counts, and how far a bias reaches."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

CONFIDENCE = 0.99
"""Of every interval in a record."""
Z = NormalDist().inv_cdf((1 + CONFIDENCE) / 2)
_FLAT = 0.1
"""An error that falls with a power smaller than this from one count to the next has met its floor."""


@dataclass(frozen=True)
class Estimate:
    """A number and the interval that holds the truth with probability `CONFIDENCE`."""

    value: float
    low: float
    high: float


def rmse(errors: np.ndarray, excess: float, reference_error: float) -> Estimate:
    """Return the root of the mean square of the replicates' errors.

    errors           (replicates,) mean - reference
    excess           excess kurtosis of a replicate's mean: it makes mean squares noisier than chi-square's law, whose degrees
                     of freedom are lowered to fit (Satterthwaite 1946)
    reference_error  the most that the reference is off
    """
    from scipy.special import chdtri

    value = float(np.sqrt(np.mean(np.square(errors))))
    freedom = len(errors) / (1 + max(excess, 0.0) / 2)
    most, least = (float(chdtri(freedom, tail)) for tail in ((1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2))
    low = value * math.sqrt(freedom / most) if most > 0 else 0.0
    high = value * math.sqrt(freedom / least) if least > 0 else math.inf  # so heavy a tail leaves no upper end
    return Estimate(value, max(low - reference_error, 0.0), high + reference_error)


def slope(counts: np.ndarray, values: np.ndarray, freedom: np.ndarray) -> Estimate | None:
    """Return the power of the count with which the RMSE falls, by weighted least squares in logarithms.

    freedom  degrees of freedom of each mean square: its logarithm has the variance psi'(freedom / 2), that of the RMSE a fourth
    """
    from scipy.special import digamma, polygamma

    good = (values > 0) & (freedom > 0)
    if np.count_nonzero(good) < 2:
        return None
    half = 0.5 * freedom[good]
    x = np.log(counts[good].astype(float))
    y = np.log(values[good]) - 0.5 * (digamma(half) - np.log(half))
    weight = 4 / polygamma(1, half)
    x = x - np.average(x, weights=weight)
    spread = float(np.sum(weight * x * x))
    found = float(np.sum(weight * x * y)) / spread
    reach = Z / math.sqrt(spread)
    return Estimate(found, found - reach, found + reach)


@dataclass(frozen=True)
class Falling:
    """How the error of something that is not random falls with its steps.

    order     the error is of order steps^-order; the interval is that of the slopes between neighbouring counts
    floor     the smallest error reached
    at        with so many steps
    reached   whether more steps no longer help there
    """

    order: Estimate | None
    floor: float
    at: int
    reached: bool


def falling(counts: np.ndarray, errors: np.ndarray, resolution: np.ndarray) -> Falling:
    """Return the order and the floor of |errors| over the counts; below `resolution` they are not to be told from rounding."""
    size = np.abs(errors)
    best = int(np.argmin(size))
    end = len(size)
    local = np.empty(0)
    with np.errstate(divide="ignore", invalid="ignore"):
        if len(size) > 1:
            local = -np.diff(np.log(size)) / np.diff(np.log(counts.astype(float)))
    for k, power in enumerate(local):
        if size[k] <= resolution[k] or not power > _FLAT:
            end = k + 1
            break
    while end > 1 and size[end - 1] <= resolution[end - 1]:
        end -= 1
    usable = local[: end - 1]
    usable = usable[np.isfinite(usable)]
    reached = bool(size[best] <= resolution[best] or (len(local) > 0 and end < len(size)))
    order = None
    if len(usable):
        x = np.log(counts[:end].astype(float))
        y = np.log(size[:end])
        fit = -float(np.polyfit(x, y, 1)[0])
        order = Estimate(fit, float(usable.min()), float(usable.max()))
    return Falling(order, float(size[best]), int(counts[best]), reached)
