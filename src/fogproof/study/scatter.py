"""How far measured errors and variances scatter: degrees of freedom and standard errors, from the fourth moment."""

from __future__ import annotations

import math

from fogproof.checks.statistics.moments import Moments
from fogproof.study.aggregate import Level
from fogproof.study.between_replicates import Calls
from fogproof.study.cells import Cell


def kurtosis(cell: Cell, level: Level, data: Moments, calls: Calls = "independent") -> float:
    """Return the excess kurtosis of a replicate's mean: 0 of scrambled or stratified points, all of it if a call is one number."""
    if cell.points == "sobol" or calls == "stratified":
        return 0.0
    return excess(data) / (1 if calls == "dependent" else level.count)


def degrees_of_freedom(cell: Cell, level: Level, data: Moments, calls: Calls = "independent") -> float:
    """Return the degrees of freedom of a level's mean square."""
    return len(level.rows) / (1 + max(kurtosis(cell, level, data, calls), 0.0) / 2)


def spread(data: Moments) -> float:
    """Return the standard error of the logarithm of the variance."""
    return math.sqrt(max(excess(data) + 2, 0.0) / max(data.n, 1))


def excess(data: Moments) -> float:
    """Return the excess kurtosis, 0 where nothing varies."""
    return data.n * (data.m4 / data.m2) / data.m2 - 3 if data.m2 > 0 else 0.0
