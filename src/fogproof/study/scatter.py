"""How far measured errors and variances scatter: degrees of freedom and standard errors, from the fourth moment."""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.statistics.moments import Moments
from fogproof.study.aggregate import Level
from fogproof.study.between_replicates import Calls
from fogproof.study.cells import Cell

ALIKE = 5e4
"""Degrees of freedom of what does not scatter: a power law is told of it where it keeps to that within half a per cent."""


def kurtosis(cell: Cell, level: Level, data: Moments, calls: Calls = "independent") -> float:
    """Return the excess kurtosis of a replicate's mean: 0 of scrambled or stratified points, all of it if a call is one number."""
    if cell.points == "sobol" or calls == "stratified":
        return 0.0
    return excess(data) / (1 if calls == "dependent" else level.count)


def degrees_of_freedom(cell: Cell, level: Level, data: Moments, calls: Calls = "independent") -> float:
    """Return the degrees of freedom of a level's mean square."""
    return len(level.rows) / (1 + max(kurtosis(cell, level, data, calls), 0.0) / 2)


def freedom_of_errors(cell: Cell, level: Level, data: Moments, calls: Calls = "independent") -> float:
    """Return the degrees of freedom of a level's mean square error, a bias included, which makes it scatter less.

    Of a chi-square law with the mean and the variance of the mean of squares (b + s z)^2 (Satterthwaite 1946); what has no scatter
    at all has `ALIKE`.
    """
    off = level.rows[:, 1] - float(cell.reference.value)
    own, n = degrees_of_freedom(cell, level, data, calls), len(off)
    noise = float(np.var(off, ddof=1)) if n > 1 else math.nan
    bias = max(float(off.mean()) ** 2 - noise / n, 0.0)
    if not (own > 0 and noise + bias > 0):
        return own
    share = noise / (noise + bias)
    varies = share**2 / own + 2 * share * (1 - share) / n
    return min(1 / varies, ALIKE) if varies > 0 else ALIKE


def spread(data: Moments) -> float:
    """Return the standard error of the logarithm of the variance."""
    return math.sqrt(max(excess(data) + 2, 0.0) / max(data.n, 1))


def excess(data: Moments) -> float:
    """Return the excess kurtosis, 0 where nothing varies."""
    return data.n * (data.m4 / data.m2) / data.m2 - 3 if data.m2 > 0 else 0.0
