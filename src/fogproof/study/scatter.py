"""How far measured errors and variances scatter: degrees of freedom and standard errors, from the fourth moment."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.two_values import two_valued
from fogproof.study.aggregate import Level
from fogproof.study.between_replicates import Calls
from fogproof.study.cells import Cell
from fogproof.study.convergence import Z
from fogproof.study.judgement import excess, tail_of


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


def beyond(levels: Sequence[Level], data: Moments, value: float) -> float:
    """Return how much, as a logarithm, values too rare to be met may add to the variance; inf where nothing bounds it.

    Deviations beyond the largest are taken to grow rare like the power -a, a being as small as Hill's (1975) estimate allows. Above
    M, where one of n is expected, lies M^2 / n a / (a - 2) of the variance.
    """
    if two_valued(data) or not data.m2 > 0:
        return 0.0
    tail = tail_of(levels, data, value)
    index, error = tail.outermost()
    if index == math.inf:
        return 0.0
    least = index - Z * error
    if least <= 2:
        return math.inf
    k = round((index / error) ** 2)
    top = np.sort(tail.largest)[::-1]
    end = max(float(top[0]), float(top[k]) * k ** (1 / least))
    return math.log1p(end**2 / data.n * least / (least - 2) / data.variance)
