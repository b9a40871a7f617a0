"""How many samples the best of all tests needs to tell one known error from none: what fewer samples cannot show is nobody's fault.

Neyman & Pearson's test of one law against another at false-alarm probability alpha needs about (z_alpha + z_miss)^2 / D samples,
with D the chi-square distance of the two; where D is large, log(1/alpha) events at least. A distance taken before the samples are
mapped (of the uniforms) is an upper bound of that of the samples, so that the count is a lower one.
"""

from __future__ import annotations

import math

import numpy as np

ALPHA, MISS = 1e-6, 0.01


def samples_needed(distance: float, alpha: float = ALPHA, miss: float = MISS) -> float:
    """Return the samples that the best test needs at a chi-square distance; inf at 0.

    >>> round(samples_needed(0.01))
    5016
    """
    from scipy.special import ndtri

    if distance <= 0:
        return math.inf
    if not math.isfinite(distance):
        return 1.0
    normal = float((ndtri(alpha) + ndtri(miss)) ** 2) / distance
    return max(normal, math.log(1 / alpha) / math.log1p(distance))


def chi_square_distance(wrong: np.ndarray, right: np.ndarray) -> float:
    """Return sum((wrong - right)^2 / right) of two laws on the same entries; inf where something impossible is drawn."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.sum(np.where(right > 0, (wrong - right) ** 2 / right, np.where(wrong > 0, np.inf, 0.0))))


def mean_needed(shift: float, variance: float, alpha: float = ALPHA, miss: float = MISS) -> float:
    """Return the samples that the best test of means needs to see a shift of a normal law; inf at no shift."""
    return samples_needed(
        math.inf if variance <= 0 < abs(shift) else shift * shift / max(variance, 1e-300), alpha, miss
    )
