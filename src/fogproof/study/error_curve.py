"""A cell's error against time, and the times to the errors that are asked for, read off it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fogproof.checks.statistics.moments import Moments
from fogproof.contracts import Reference
from fogproof.study.aggregate import Level
from fogproof.study.cells import Cell
from fogproof.study.convergence import Estimate, Floor
from fogproof.study.judgement import Judged
from fogproof.study.reaching import TARGETS, ErrorOverTime, Reach, reach_of, variance_law
from fogproof.study.scatter import degrees_of_freedom, spread
from fogproof.study.speed import Times

_NO_LAW = 0.001
"""Measured errors so improbable under sqrt(variance / count) are taken as they are: realisations in a call depend on each other."""


def error_curve(
    cell: Cell,
    levels: Sequence[Level],
    errors: Sequence[Estimate],
    times: Sequence[Times],
    data: Moments,
    variance: Reference | None,
    judged: Judged,
    stays: float,
) -> ErrorOverTime | None:
    """Return the error against time; None where nothing was drawn, or not every realisation is a number."""
    if not levels or any(level.bad for level in levels):
        return None
    counts = np.array([level.count for level in levels])
    law = None
    if (
        cell.method.axis == "samples"
        and cell.points == "random"
        and judged.outcome != "rejected"
        and not judged.infinite
    ):
        exact = variance is not None and 0 <= float(variance.error) < 1e-6 * float(variance.value) < math.inf
        law = variance_law(
            float(variance.value) if exact and variance is not None else data.variance, spread(data), exact
        )
        law = law if data.m2 > 0 and _follows(law.value, cell, levels, errors, data) else None
    return ErrorOverTime(counts, errors, times, law, stays)


def stays_for_good(judged: Judged, bias: Estimate | None, floor: Floor | None) -> float:
    """Return the error that is there for good: a march's floor where it has met it, or the least bias a rejected one can have."""
    if floor is not None:
        return floor.error if floor.reached else 0.0
    if judged.outcome != "rejected" or bias is None or not bias.low * bias.high > 0:
        return 0.0
    return min(abs(bias.low), abs(bias.high))


def _follows(variance: float, cell: Cell, levels: Sequence[Level], errors: Sequence[Estimate], data: Moments) -> bool:
    """Return whether the errors that were measured are those of independent realisations with this variance."""
    from scipy.special import chdtr, chdtrc

    freedom = np.array([degrees_of_freedom(cell, level, data) for level in levels])
    squares = np.array([e.value**2 * level.count / variance for e, level in zip(errors, levels, strict=True)])
    statistic, total = float(np.sum(freedom * squares)), float(np.sum(freedom))
    return 2 * min(float(chdtr(total, statistic)), float(chdtrc(total, statistic))) >= _NO_LAW


def reaches_of(curve: ErrorOverTime, value: float, hidden: float) -> tuple[Reach, ...]:
    """Return the times to `TARGETS`; () if the reference is 0 or known too coarsely."""
    if not value > 0 or hidden > 0.1 * TARGETS[-1] * value:
        return ()
    reaches: list[Reach] = []
    for error in TARGETS:
        reach = reach_of(curve, error * value, error, hidden)
        sooner = reach.reached and reaches and reach.times.estimate.value < reaches[-1].times.estimate.value
        reaches.append(
            replace(reach, times=reaches[-1].times) if sooner else reach
        )  # a smaller error takes no less time
    return tuple(reaches)
