"""A cell's error against time, and the times to the errors that are asked for, read off it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fogproof.checks.statistics.moments import Moments
from fogproof.contracts import Reference
from fogproof.study.aggregate import Level, pooled
from fogproof.study.cells import Cell
from fogproof.study.convergence import Estimate, Floor
from fogproof.study.judgement import Judged
from fogproof.study.reaching import TARGETS, ErrorOverTime, Reach, reach_of, variance_law
from fogproof.study.replicate_means import student_quantile
from fogproof.study.scatter import degrees_of_freedom, spread
from fogproof.study.speed import Times
from fogproof.study.tails import beyond

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
    bias: Estimate | None,
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
        and judged.calls in ("independent", "doubtful")
        and not judged.doubted
        and not cell.method.bias
        and not judged.infinite
    ):
        exact = variance is not None and 0 <= float(variance.error) < 1e-6 * float(variance.value) < math.inf
        size = float(variance.value) if exact and variance is not None else data.variance
        law = variance_law(size, spread(data), beyond(levels, data, float(cell.reference.value)), exact)
        alike = data.m2 == 0  # values that were not met make the variance, if it is known that there is one
        law = (
            law
            if (exact and alike and size > 0) or (not alike and _follows(size, cell, levels, errors, data))
            else None
        )
        # Where calls depend on each other too weakly to be told, their error is that of so much more variance.
        law = law and replace(law, high=law.high * judged.design_effect)
    hidden = 0.0 if law is None or bias is None else max(-bias.low, bias.high)
    if law is None and data.n and data.low == data.high and not cell.method.bias:
        hidden = next((f.resolution.value for f in judged.findings if f.check == "mean" and f.resolution), 0.0)
    rare = judged.rare and not (cell.method.bias and data.low == data.high)
    smooth = cell.method.axis != "samples"
    return ErrorOverTime(counts, errors, times, law, stays, smooth, bias=hidden, rare=rare)


def stays_for_good(
    cell: Cell, judged: Judged, bias: Estimate | None, floor: Floor | None, levels: Sequence[Level], data: Moments
) -> float:
    """Return the error that is there for good: a march's floor where it has met it, or the least bias a rejected one can have.

    A bias that is not the same at all counts may fall further: nothing of it is there for good. That of what declares one, and is
    the same number whatever is drawn, is.
    """
    if floor is not None:
        return floor.error if floor.reached else 0.0
    constant = bool(cell.method.bias) and cell.method.axis == "samples" and data.n > 0 and data.low == data.high
    if not (judged.outcome == "rejected" or constant) or bias is None or not bias.low * bias.high > 0:
        return 0.0
    apart = cell.points == "sobol" or judged.calls != "independent"
    if not (_intervals_meet(levels) if apart else _alike(levels, data)):
        return 0.0
    return min(abs(bias.low), abs(bias.high))


def _intervals_meet(levels: Sequence[Level]) -> bool:
    """Return whether the means of replicates at all counts, with Student's intervals, may be one and the same."""
    lows, highs = [], []
    for level in levels:
        means, n = level.rows[:, 1], len(level.rows)
        reach = (
            student_quantile(n - 1, _NO_LAW / len(levels)) * float(means.std(ddof=1)) / math.sqrt(n)
            if n > 1
            else math.inf
        )
        reach += 1e-12 * abs(float(means.mean()))
        lows.append(float(means.mean()) - reach)
        highs.append(float(means.mean()) + reach)
    return max(lows) <= min(highs)


def _alike(levels: Sequence[Level], data: Moments) -> bool:
    """Return whether the means at all counts may be one and the same."""
    from scipy.special import chdtrc

    means = np.array([pooled(level.rows).mean for level in levels])
    n = np.array([pooled(level.rows).n for level in levels])
    if data.m2 <= data.n * (4 * np.finfo(float).eps * data.mean) ** 2:
        return bool(np.ptp(means) <= 1e-12 * np.abs(means).max())
    statistic = float(np.sum(n * (means - data.mean) ** 2)) / data.variance
    return len(means) < 2 or float(chdtrc(len(means) - 1, statistic)) >= _NO_LAW


def _follows(variance: float, cell: Cell, levels: Sequence[Level], errors: Sequence[Estimate], data: Moments) -> bool:
    """Return whether the errors that were measured are those of independent realisations with this variance."""
    from scipy.special import chdtr, chdtrc

    freedom = np.array([degrees_of_freedom(cell, level, data) for level in levels])
    squares = np.array([e.value**2 * level.count / variance for e, level in zip(errors, levels, strict=True)])
    one_each = min(
        2 * len(levels) * min(float(chdtr(f, f * s)), float(chdtrc(f, f * s)))
        for f, s in zip(freedom, squares, strict=True)
    )
    statistic, total = float(np.sum(freedom * squares)), float(np.sum(freedom))
    together = 2 * min(float(chdtr(total, statistic)), float(chdtrc(total, statistic)))
    return min(one_each, together) >= _NO_LAW


def reaches_of(curve: ErrorOverTime, value: float, hidden: float) -> tuple[Reach, ...]:
    """Return the times to `TARGETS`; () if the reference is 0 or known too coarsely."""
    if not value > 0 or hidden > 0.1 * TARGETS[-1] * value:
        return ()
    reaches: list[Reach] = []
    for error in TARGETS:
        reach = reach_of(curve, error * value, error, hidden)
        if reach.reached and reach.how != "less-than" and reach.samples != curve.counts[0]:
            reach = replace(reach, call=curve.times[0])
        reaches.append(reach.after(reaches[-1]) if reaches else reach)
    return tuple(reaches)
