"""How far measured errors and variances scatter: degrees of freedom and standard errors, from the fourth moment."""

from __future__ import annotations

import math

from fogproof.checks.statistics.moments import Moments
from fogproof.study.aggregate import Level
from fogproof.study.cells import Cell
from fogproof.study.judgement import excess


def kurtosis(cell: Cell, data: Moments) -> float:
    """Return the excess kurtosis of realisations, 0 where they are means of scrambled points."""
    return 0.0 if cell.points == "sobol" else excess(data)


def degrees_of_freedom(cell: Cell, level: Level, data: Moments) -> float:
    """Return the degrees of freedom of a level's mean square."""
    return len(level.rows) / (1 + max(kurtosis(cell, data) / level.count, 0.0) / 2)


def spread(data: Moments) -> float:
    """Return the standard error of the logarithm of the variance."""
    return math.sqrt(max(excess(data) + 2, 0.0) / max(data.n, 1))
