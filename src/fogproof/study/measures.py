"""All that is said of one cell, JSON-ready: what depends on the draws alone, and under "speed" what depends on the machine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from fogproof.checks.statistics.moments import Moments
from fogproof.contracts import Reference
from fogproof.study.aggregate import Level, pooled
from fogproof.study.between_replicates import Calls
from fogproof.study.cells import Cell
from fogproof.study.convergence import CONFIDENCE, Estimate, Floor, Order, Z, floor_of, order_of, rmse
from fogproof.study.error_curve import error_curve, reaches_of, stays_for_good
from fogproof.study.fixed_work import summed_up
from fogproof.study.judgement import BY_BIAS, Judged, doubted, inherited, judge, out_of_range, resolution_of
from fogproof.study.methods.table import kind_of, options_of
from fogproof.study.reaching import TARGETS, Reach
from fogproof.study.replicate_means import student_quantile
from fogproof.study.scatter import freedom_of_errors, kurtosis, spread
from fogproof.study.speed import Times, times_of
from fogproof.study.tails import beyond

_LEVEL = 0.2
"""An error of which so much stays for good is on its way to a level, not down a power of the count."""


@dataclass(frozen=True, eq=False)
class Measured:
    """A cell, judged and measured.

    reaches   the time to each of `TARGETS`, () where there is no curve to read it off
    failed    the least count that could not be drawn, 0 if none
    """

    cell: Cell
    judged: Judged
    reaches: tuple[Reach, ...]
    record: dict[str, Any]
    failed: int = 0

    @property
    def status(self) -> str:
        """`passed`, `known` (biased, as declared, whether that is seen or not), `rejected` or `inconclusive`."""
        outcome = self.judged.outcome
        if self.cell.method.expected == "rejected" and (outcome == "rejected" or self.cell.method.axis == "samples"):
            return "known" if self.judged.wrong <= BY_BIAS else "rejected"
        return {"rejected": "rejected", "not rejected": "passed"}.get(outcome, "inconclusive")

    @property
    def unbiased(self) -> bool:
        """Whether it came out unbiased as far as could be seen, and does not say otherwise."""
        return self.status == "passed"

    @property
    def unfinished(self) -> bool:
        """Whether something of it has not been drawn yet."""
        return not self.failed and any(f.check == "completeness" for f in self.judged.findings)

    @property
    def waited_for(self) -> bool:
        """Whether more samples may bring it nearer: what was rejected is to be mended first, as is what cannot be drawn."""
        return self.status != "rejected" and not self.failed


def measure(
    cell: Cell, levels: Sequence[Level], alpha: float, twin: Measured | None = None, failed: int = 0
) -> Measured:
    """Measure a cell; every test has the false-alarm probability alpha. The twin has the other points."""
    levels = [level for level in levels if len(level.rows)]
    variance = cell.method.variance(cell.scene)
    judged = judge(cell, levels, variance, alpha)
    if twin is not None:
        judged = (inherited if cell.points == "sobol" else doubted)(judged, twin.judged)
    levels = [] if out_of_range(cell, levels) else levels  # what cannot be summed cannot be measured
    value, error = float(cell.reference.value), float(cell.reference.error)
    data = pooled(np.concatenate([level.rows for level in levels])) if levels else Moments()
    calls = judged.calls
    errors, times = [_rmse(cell, level, data, error, calls) for level in levels], times_of(levels)
    order, floor = _fall(cell, levels, errors, data, value, error, calls)
    bias = _bias(cell, levels, data, error, judged)
    stays = stays_for_good(cell, judged, bias, floor, levels, data)
    if order is not None and floor is None and stays > _LEVEL * errors[-1].value:
        order = None  # it falls to its bias, and no further
    curve = error_curve(cell, levels, errors, times, data, variance, judged, stays, bias)
    reaches = () if curve is None else reaches_of(replace(curve, ends=failed > 0), abs(value), error)
    record = {
        "name": cell.name,
        "kind": kind_of(cell.method),
        "title": cell.method.title,
        "label": _label(cell),
        "options": options_of(cell.method),
        "points": cell.points,
        "axis": cell.method.axis,
        "expected": cell.method.expected,
        "reason": cell.method.bias,
        "outcome": judged.outcome,
        "warning": judged.warning,
        "times_as_many": judged.times_as_many,
        "calls": calls,
        "findings": judged.findings,
        "moments": _moments(data),
        "bias": None if bias is None else asdict(bias),
        "variance": _variance(cell, levels, data, variance, calls),
        "order": None if order is None else {**asdict(order), "expected": _expected_order(cell)},
        "floor": None if floor is None else asdict(floor),
        "cost": levels[-1].cost if levels and not math.isnan(levels[-1].cost) else None,
        "counts": [_count(cell, level, e, variance) for level, e in zip(levels, errors, strict=True)],
        "speed": _speed(cell, levels, times, reaches) if levels else None,
    }
    measured = Measured(cell, judged, reaches, record, failed)
    record["status"] = measured.status
    record["unbiased_to"] = _unbiased_to(measured)
    return measured


def _unbiased_to(m: Measured) -> float | None:
    """Return the relative bias that would have been seen, where that is more than the least error asked for; None elsewhere."""
    if m.status != "passed":
        return None
    seen = next((f.resolution.relative for f in m.judged.findings if f.check == "mean" and f.resolution), None)
    return seen if seen is not None and seen > TARGETS[-1] else None


def _label(cell: Cell) -> str:
    """Return the title; where the scene has it more than once, with the kind of a method and the options that tell it apart."""
    alike = [method for method in cell.scene.estimators if method.title == cell.method.title]
    kinds = {kind_of(method) for method in alike}
    more = [kind_of(cell.method)] if len(kinds) > 1 else []
    more += [f"{key} {value}" for key, value in options_of(cell.method).items()] if len(alike) > 1 else []
    label = f"{cell.method.title} ({', '.join(more)})" if more else cell.method.title
    return f"{label} with Sobol points" if cell.points == "sobol" else label


def _moments(data: Moments) -> dict[str, Any]:
    names = ("n", "mean", "m2", "m3", "m4", "low", "high")
    return {name: getattr(data, name) for name in names}


def _rmse(cell: Cell, level: Level, data: Moments, error: float, calls: Calls) -> Estimate:
    errors = level.rows[:, 1] - float(cell.reference.value)
    if cell.method.axis != "samples":
        size = float(np.abs(errors).max())
        return Estimate(size, max(size - error, 0.0), size + error)
    return rmse(errors, kurtosis(cell, level, data, calls), error)


def _fall(
    cell: Cell,
    levels: Sequence[Level],
    errors: Sequence[Estimate],
    data: Moments,
    value: float,
    error: float,
    calls: Calls,
) -> tuple[Order | None, Floor | None]:
    """Return the order with which the error falls, and how near a march comes."""
    if not levels or cell.method.axis == "nothing":
        return None, None
    counts = np.array([level.count for level in levels])
    size = np.array([e.value for e in errors])
    steps = cell.method.axis == "steps"
    hidden = np.array([resolution_of(value, error, level.count if steps else 1) for level in levels])
    freedom = np.array([math.inf if steps else freedom_of_errors(cell, level, data, calls) for level in levels])
    return order_of(counts, size, freedom, hidden), floor_of(counts, size, hidden) if steps else None


def _expected_order(cell: Cell) -> float | None:
    return 0.5 if cell.method.axis == "samples" and cell.points == "random" else None


def _bias(cell: Cell, levels: Sequence[Level], data: Moments, error: float, judged: Judged) -> Estimate | None:
    """Return the mean less the reference: of all realisations if these are independent, else of the largest count's replicates."""
    if not levels or any(level.bad for level in levels):
        return None
    value, means = float(cell.reference.value), levels[-1].rows[:, 1]
    off, reach = float(means.mean()) - value, 0.0
    if cell.method.axis == "samples":
        one = len(means) < 2  # one alone says nothing of its scatter
        stderr = math.nan if one else float(means.std(ddof=1)) / math.sqrt(len(means))
        reach = math.nan if one else student_quantile(len(means) - 1, (1 - CONFIDENCE) / 2) * stderr
        if cell.points == "random" and judged.calls in ("independent", "doubtful"):
            off = data.mean - value
            own = Z * math.sqrt(judged.design_effect) * data.stderr
            reach = max(own, reach) if judged.calls == "doubtful" else own
    return Estimate(off, off - reach - error, off + reach + error)


def _variance(
    cell: Cell, levels: Sequence[Level], data: Moments, variance: Reference | None, calls: Calls
) -> dict[str, Any] | None:
    """Return the variance of a realisation; None where realisations are not independent, and no interval is known."""
    if cell.points == "sobol" or data.n < 2 or calls in ("dependent", "stratified"):
        return None
    reach = Z * spread(data)
    measured, more = data.variance, beyond(levels, data, float(cell.reference.value))
    return {
        "measured": measured,
        "low": measured * math.exp(-reach),
        "high": math.inf if more == math.inf else measured * math.exp(reach + more),
        "exact": None if variance is None else float(variance.value),
        "exact_error": None if variance is None else float(variance.error),
        "method": None if variance is None else variance.method,
    }


def _count(cell: Cell, level: Level, error: Estimate, variance: Reference | None) -> dict[str, Any]:
    predicted = None
    if cell.points == "random" and cell.method.axis == "samples" and variance is not None:
        predicted = math.sqrt(max(float(variance.value), 0.0) / level.count)
    return {
        "count": level.count,
        "replicates": len(level.rows),
        "mean": float(level.rows[:, 1].mean()),
        "rmse": error.value,
        "rmse_low": error.low,
        "rmse_high": error.high,
        "predicted": predicted,
    }


def _speed(cell: Cell, levels: Sequence[Level], times: Sequence[Times], reaches: Sequence[Reach]) -> dict[str, Any]:
    """Return what depends on the machine; rank and relative speed are added once the scene's soonest is known."""
    last = levels[-1]
    each = last.count if cell.method.axis == "samples" else 1
    whole = times[-1].estimate
    return {
        "cpu": {"value": whole.value / each, "low": whole.low / each, "high": whole.high / each},
        "wall": last.wall,
        "batches": last.batches,
        "cpu_total": sum(level.cpu_total for level in levels),
        "counts": [_timing(level, time) for level, time in zip(levels, times, strict=True)],
        "targets": [_target(reach) for reach in reaches],
    }


def _timing(level: Level, times: Times) -> dict[str, Any]:
    time = times.estimate
    fixed = summed_up(level.over_fixed)
    return {"count": level.count, "seconds": time.value, "low": time.low, "high": time.high, "fixed_work": fixed}


def _target(reach: Reach) -> dict[str, Any]:
    time = reach.seconds
    told = {"error": reach.error, "how": reach.how, "why": reach.why, "samples": reach.samples, "unless": reach.unless}
    if not reach.reached:
        return {**told, "seconds": None, "low": reach.at_least, "high": None}
    return {**told, "seconds": time.value, "low": time.low, "high": time.high}
