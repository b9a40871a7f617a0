"""Sums of residuals of labels in cells, and their chi-square; see `labels`."""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.chi_square import pooled
from fogproof.checks.statistics.tails import chi_square_detected, gamma_above

LEAST = 10.0
"""Variance of the sum of a cell whose square may enter a chi-square."""


def sums_in(cell: np.ndarray, cells: int, labels: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return (4, cells) sums of residuals, of their variances, third moments and squared variances.

    cell    (n,) number of each point's cell
    labels  (n,) 0 or 1
    w       (n,) their probabilities
    """
    variance = w * (1 - w)
    columns = (labels - w, variance, variance * (1 - 2 * w), variance * variance)
    return np.stack([np.bincount(cell, column, cells) for column in columns])


def chi_square(columns: np.ndarray) -> tuple[float, float, int]:
    """Return the p-value of sums (4, m), the statistic, and its degrees of freedom; small sums are pooled.

    The square of a sum over its variance has mean 1 exactly; its second and third cumulants follow from those of the sum, and the
    p-value is that of the gamma law with the three (Pearson's type III).
    """
    groups = pooled(columns[1], LEAST)
    total, variance, third, squares = (np.bincount(groups, column) for column in columns)
    cells = len(total)
    statistic = float(np.sum(total**2 / variance))
    fourth = (variance - 6 * squares) / variance**2
    skewness = third**2 / variance**3
    second_cumulant = float(np.sum(2 + fourth))
    third_cumulant = float(np.sum(8 + 12 * fourth + 10 * skewness))
    shape, scale = 4 * second_cumulant**3 / third_cumulant**2, third_cumulant / (2 * second_cumulant)
    return gamma_above(shape, (statistic - cells) / scale + shape), statistic, cells


def detected(cells: int, alpha: float, doubt: float) -> float:
    """Return the misfit that a chi-square on so many cells sees, `doubt` being the variance of all residuals."""
    seen = math.sqrt(chi_square_detected(max(cells, 1), alpha, MISS) / doubt)
    return seen * (1 + 0.5 * seen)
