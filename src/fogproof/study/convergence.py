"""How the error falls: RMSE at each count with an interval, and the order of the fall where it follows a power of the count."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

CONFIDENCE = 0.99
"""Of every interval in a record."""


def deviations(confidence: float) -> float:
    """Return how many standard deviations on either side hold so much of a normal law."""
    return NormalDist().inv_cdf((1 + confidence) / 2)


Z = deviations(CONFIDENCE)
ABOVE = 20.0
"""Errors count towards an order where they are so many times what rounding and the reference may hide."""
_LEAST_NOISY, _LEAST_SMOOTH = 3, 4
"""Counts that an order needs: one more than a line has parameters, two more where their own scatter must tell how sure it is."""
_MISFIT = 0.001
"""A line through noisy errors is none where chance explains their distance from it with a smaller probability."""
_BEND = 0.1
"""How far the order of errors without noise may drift over the counts it is fitted to, unless their scatter hides it."""
_BETTER = 1e-4
"""A later stretch of errors without noise is taken where chance makes it scatter so much less with a smaller probability."""
_COARSE = 0.5
"""An order that is not known to this is none."""


@dataclass(frozen=True)
class Estimate:
    """A number and the interval that holds the truth with probability `CONFIDENCE`."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Order(Estimate):
    """The error falls like count^-value from the count `first` to `last`.

    points  counts it is fitted to
    misfit  by what factor the errors scatter about the fit, root mean square
    p       probability of so large a misfit by chance; None where the errors are not random
    """

    first: int
    last: int
    points: int
    misfit: float
    p: float | None


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


def order_of(counts: np.ndarray, errors: np.ndarray, freedom: np.ndarray, hidden: np.ndarray) -> Order | None:
    """Return the power of the count with which the error falls, where it does: at the largest counts above the floor.

    Of the stretches of counts that end there the longest is taken on which a line fits the logarithms. None fits where the
    asymptote lies beyond the counts, or all errors are within rounding.

    errors   RMSE, or |error| of what is not random
    freedom  degrees of freedom of each mean square, whose logarithm has the variance psi'(freedom / 2), that of the RMSE a
             fourth; inf for what is not random: then the errors' own scatter says how sure the order is (Student's t)
    hidden   what rounding and the reference may hide of each error
    """
    end = len(errors)
    while end > 0 and not errors[end - 1] > ABOVE * hidden[end - 1]:
        end -= 1
    begin = end
    while begin > 0 and errors[begin - 1] > ABOVE * hidden[begin - 1] and freedom[begin - 1] > 0:
        begin -= 1
    counts, errors, freedom = counts[begin:end], errors[begin:end], freedom[begin:end]
    return _noisy_order(counts, errors, freedom) if np.isfinite(freedom).all() else _smooth_order(counts, errors)


def _noisy_order(counts: np.ndarray, errors: np.ndarray, freedom: np.ndarray) -> Order | None:
    """Return the weighted least squares line through the longest stretch that chi-square's law of the residuals lets pass."""
    from scipy.special import chdtrc, digamma, polygamma

    half = 0.5 * freedom
    y = np.log(errors) - 0.5 * (digamma(half) - np.log(half))
    weight = 4 / polygamma(1, half)
    for first in range(len(y) - _LEAST_NOISY + 1):
        x = np.log(counts[first:].astype(float))
        slope, spread, residuals = _line(x, y[first:], weight[first:])
        p = float(chdtrc(len(x) - 2, float(np.sum(weight[first:] * residuals**2))))
        reach = Z / math.sqrt(spread)
        if p >= _MISFIT and reach <= _COARSE:
            if abs(slope) < reach:  # level: it neither falls nor grows
                return None
            return _order(counts[first:], -slope, reach, residuals, p)
    return None


def _smooth_order(counts: np.ndarray, errors: np.ndarray) -> Order | None:
    """Return the least squares line through the longest stretch that no later one betters (F-test), if that does not bend."""
    from scipy.special import fdtrc, stdtrit

    x, y = np.log(counts.astype(float)), np.log(errors)
    best, least, freedom = None, math.inf, 0
    for first in range(len(x) - _LEAST_SMOOTH + 1):
        _, _, residuals = _line(x[first:], y[first:], np.ones(len(x) - first))
        own = len(x) - first - 2
        scatter = float(np.sum(residuals**2)) / own + 1e-24
        if best is None or fdtrc(freedom, own, least / scatter) < _BETTER:
            best, least, freedom = first, scatter, own
    if best is None:
        return None
    x, y, counts = x[best:], y[best:], counts[best:]
    slope, spread, residuals = _line(x, y, np.ones(len(x)))
    drift = _drift(x, y)
    reach = math.sqrt(least / spread) * float(stdtrit(freedom, (1 + CONFIDENCE) / 2)) + 0.5 * drift
    return _order(counts, -slope, reach, residuals, None) if drift < math.inf and reach <= _COARSE else None


def _drift(x: np.ndarray, y: np.ndarray) -> float:
    """Return by how much the slope changes along a parabola through the points; inf if that is much and no scatter explains it."""
    from scipy.special import stdtrit

    design = np.vander(x - x.mean(), 3)
    bend, slope, start = np.linalg.lstsq(design, y, rcond=None)[0]
    freedom = len(x) - 3
    scatter = math.sqrt(float(np.sum((y - design @ [bend, slope, start]) ** 2)) / freedom)
    unsure = scatter * math.sqrt(float(np.linalg.inv(design.T @ design)[0, 0]))
    drift = 2 * abs(float(bend)) * float(np.ptp(x))
    sure = abs(bend) > unsure * float(stdtrit(freedom, (1 + CONFIDENCE) / 2))
    return math.inf if sure and drift > _BEND else drift if sure else 0.0


def _line(x: np.ndarray, y: np.ndarray, weight: np.ndarray) -> tuple[float, float, np.ndarray]:
    """Return the slope, the weighted sum of squares of x about its mean, and the residuals."""
    x, y = x - np.average(x, weights=weight), y - np.average(y, weights=weight)
    spread = float(np.sum(weight * x * x))
    slope = float(np.sum(weight * x * y)) / spread
    return slope, spread, y - slope * x


def _order(counts: np.ndarray, value: float, reach: float, residuals: np.ndarray, p: float | None) -> Order:
    misfit = math.exp(float(np.sqrt(np.mean(residuals**2))))
    return Order(value, value - reach, value + reach, int(counts[0]), int(counts[-1]), len(counts), misfit, p)


@dataclass(frozen=True)
class Floor:
    """How near something that is not random comes.

    error    the smallest error
    at       with so many steps
    reached  whether it is rounding, or the reference's own error, that ends the fall there
    """

    error: float
    at: int
    reached: bool


def floor_of(counts: np.ndarray, errors: np.ndarray, hidden: np.ndarray) -> Floor:
    """Return the smallest of |errors|; below `hidden` they are not to be told from rounding."""
    best = int(np.argmin(errors))
    return Floor(float(errors[best]), int(counts[best]), bool(errors[best] <= hidden[best]))
