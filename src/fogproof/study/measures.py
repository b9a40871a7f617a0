"""All that is said of one cell, JSON-ready: what depends on the draws alone, and under "speed" what depends on the machine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fogproof.checks.statistics.moments import Moments
from fogproof.contracts import Reference
from fogproof.study.aggregate import Level, pooled
from fogproof.study.cells import Cell
from fogproof.study.convergence import Estimate, Falling, Z, falling, rmse, slope
from fogproof.study.judgement import Judged, excess, inherited, judge, out_of_range, resolution_of
from fogproof.study.methods.table import kind_of, options_of
from fogproof.study.speed import Efficiency, spread_of, targets_of, time_of


@dataclass(frozen=True, eq=False)
class Measured:
    """A cell, judged and measured; `efficiency` is None if it was rejected, or nothing is known of its time."""

    cell: Cell
    judged: Judged
    efficiency: Efficiency | None
    record: dict[str, Any]

    @property
    def status(self) -> str:
        """`passed`, `known` (rejected, as declared), `rejected` or `inconclusive`."""
        outcome = self.judged.outcome
        if outcome == "rejected":
            return "known" if self.cell.method.expected == "rejected" else "rejected"
        return "passed" if outcome == "not rejected" else "inconclusive"


def measure(cell: Cell, levels: Sequence[Level], alpha: float, twin: Measured | None = None) -> Measured:
    """Measure a cell; every test has the false-alarm probability alpha. The twin of Sobol points are random ones."""
    levels = [level for level in levels if len(level.rows)]
    variance = cell.method.variance(cell.scene)
    judged = judge(cell, levels, variance, alpha)
    judged = judged if twin is None else inherited(judged, twin.judged)
    levels = [] if out_of_range(cell, levels) else levels  # what cannot be summed cannot be measured
    value, error = float(cell.reference.value), float(cell.reference.error)
    rejected = judged.outcome == "rejected"
    data = pooled(np.concatenate([level.rows for level in levels])) if levels else Moments()
    curve = [_rmse(cell, level, data, error) for level in levels]
    fall = None
    if cell.method.axis == "steps" and levels:
        offs = np.array([level.rows[0, 1] - value for level in levels])
        limits = np.array([resolution_of(value, error, level.count) for level in levels])
        fall = falling(np.array([level.count for level in levels]), offs, limits)
    bias = _bias(cell, levels, data, error)
    efficiency = None if rejected or not levels else _efficiency(levels, data, variance, curve, cell)
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
        "findings": judged.findings,
        "moments": _moments(data),
        "bias": None if bias is None else asdict(bias),
        "variance": _variance(cell, data, variance),
        "slope": _slope(cell, levels, curve, data),
        "march": None if fall is None else _fall(fall),
        "cost": levels[-1].cost if levels and not math.isnan(levels[-1].cost) else None,
        "counts": [_count(cell, level, c, variance) for level, c in zip(levels, curve, strict=True)],
        "speed": _speed(cell, levels, data, variance, bias if rejected else None, curve) if levels else None,
    }
    measured = Measured(cell, judged, efficiency, record)
    record["status"] = measured.status
    return measured


def _label(cell: Cell) -> str:
    """Return the title, with the options where the scene has the same method twice."""
    alike = [method for method in cell.scene.estimators if method.title == cell.method.title]
    options = ", ".join(f"{key} {value}" for key, value in options_of(cell.method).items())
    label = f"{cell.method.title} ({options})" if len(alike) > 1 and options else cell.method.title
    return f"{label}, Sobol points" if cell.points == "sobol" else label


def _time(cell: Cell, level: Level) -> dict[str, float]:
    """Return the time of a realisation at one count, and of a whole estimate with so many samples, or steps."""
    each = time_of(level)
    whole = each.value * (level.count if cell.method.axis == "samples" else 1)
    return {"count": level.count, **asdict(each), "seconds": whole}


def _moments(data: Moments) -> dict[str, Any]:
    names = ("n", "mean", "m2", "m3", "m4", "low", "high")
    return {name: getattr(data, name) for name in names}


def _rmse(cell: Cell, level: Level, data: Moments, error: float) -> Estimate:
    errors = level.rows[:, 1] - float(cell.reference.value)
    if cell.method.axis != "samples":
        size = float(np.abs(errors).max())
        return Estimate(size, max(size - error, 0.0), size + error)
    spread = 0.0 if cell.points == "sobol" else excess(data) / level.count
    return rmse(errors, spread, error)


def _bias(cell: Cell, levels: Sequence[Level], data: Moments, error: float) -> Estimate | None:
    if not levels:
        return None
    if cell.method.axis == "samples" and cell.points == "random":
        off, reach = data.mean - float(cell.reference.value), Z * data.stderr
    else:
        means = levels[-1].rows[:, 1]
        off = float(means.mean()) - float(cell.reference.value)
        reach = Z * float(means.std(ddof=1)) / math.sqrt(len(means)) if cell.method.axis == "samples" else 0.0
    return Estimate(off, off - reach - error, off + reach + error)


def _variance(cell: Cell, data: Moments, variance: Reference | None) -> dict[str, Any] | None:
    if cell.points == "sobol" or data.n < 2:
        return None
    reach = Z * math.sqrt(max(excess(data) + 2, 0.0) / data.n)
    measured = data.variance
    return {
        "measured": measured,
        "low": measured * math.exp(-reach),
        "high": measured * math.exp(reach),
        "exact": None if variance is None else float(variance.value),
        "exact_error": None if variance is None else float(variance.error),
        "method": None if variance is None else variance.method,
    }


def _slope(
    cell: Cell, levels: Sequence[Level], curve: Sequence[Estimate], data: Moments
) -> dict[str, float | None] | None:
    if cell.method.axis != "samples":
        return None
    counts = np.array([level.count for level in levels])
    spread = 0.0 if cell.points == "sobol" else excess(data)
    freedom = np.array([len(level.rows) / (1 + max(spread / level.count, 0.0) / 2) for level in levels])
    found = slope(counts, np.array([c.value for c in curve]), freedom)
    expected = None if cell.points == "sobol" else -0.5
    return None if found is None else {**asdict(found), "expected": expected}


def _fall(fall: Falling) -> dict[str, Any]:
    order = None if fall.order is None else asdict(fall.order)
    return {"order": order, "floor": fall.floor, "at": fall.at, "reached": fall.reached}


def _count(cell: Cell, level: Level, curve: Estimate, variance: Reference | None) -> dict[str, Any]:
    predicted = None
    if cell.points == "random" and cell.method.axis == "samples" and variance is not None:
        predicted = math.sqrt(max(float(variance.value), 0.0) / level.count)
    means = level.rows[:, 1]
    return {
        "count": level.count,
        "replicates": len(level.rows),
        "mean": float(means.mean()),
        "rmse": curve.value,
        "rmse_low": curve.low,
        "rmse_high": curve.high,
        "predicted": predicted,
    }


def _efficiency(
    levels: Sequence[Level], data: Moments, variance: Reference | None, curve: Sequence[Estimate], cell: Cell
) -> Efficiency:
    """Return 1 / (mean squared error x time) of the last count; with random samples that does not depend on the count."""
    time = time_of(levels[-1])
    if cell.method.axis != "samples":
        return Efficiency(math.inf, spread_of(time))
    if cell.points == "sobol":
        size = curve[-1]
        per = size.value**2 * levels[-1].count * time.value
        spread = 2 * math.log(size.high / size.low) / (2 * Z) if size.low > 0 else 1.0
        return Efficiency(1 / per if per > 0 else math.inf, math.hypot(spread, spread_of(time)))
    square, spread = data.variance, math.sqrt(max(excess(data) + 2, 0.0) / data.n)
    if variance is not None and np.isfinite(variance.value) and float(variance.error) < 1e-6 * float(variance.value):
        square, spread = float(variance.value), 0.0
    per = square * time.value
    return Efficiency(1 / per if per > 0 else math.inf, math.hypot(spread, spread_of(time)))


def _speed(
    cell: Cell,
    levels: Sequence[Level],
    data: Moments,
    variance: Reference | None,
    bias: Estimate | None,
    curve: Sequence[Estimate],
) -> dict[str, Any]:
    """Return what depends on the machine; efficiency and rank are added once the scene's best is known."""
    exact = variance is not None and np.isfinite(variance.value)
    square = float(variance.value) if exact and variance is not None else data.variance
    off = 0.0 if bias is None else bias.value
    time, wall = time_of(levels[-1]), float(np.median(levels[-1].wall))
    return {
        "cpu": asdict(time),
        "wall": wall,
        "batches": len(levels[-1].cpu),
        "cpu_total": sum(level.cpu_total for level in levels),
        "counts": [_time(cell, level) for level in levels],
        "targets": [asdict(target) for target in targets_of(cell, levels, square, off, [c.value for c in curve])],
    }
