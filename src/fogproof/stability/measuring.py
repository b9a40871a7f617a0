"""How far a formula is from the truth over its hard regions, in units of what rounding its arguments would do."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.contracts import Reference
from fogproof.errors import NotInstalledError, stop_behind
from fogproof.stability.exact import ExactValue, exactly, flint
from fogproof.stability.formula import Evaluate, Formula, HardRegion, Precision

POINTS, POINTS_SHORT = 24, 7
"""Along each axis of a region, of the whole suite and of its short form."""

OURS = "ours"

VISIBLE = 1000.0
"""A naive form fails visibly where it is this many times worse than the bound, or where it loses half of all digits."""


@dataclass(frozen=True)
class FormError:
    """One form of a formula over one region, in one precision.

    form       "ours", or the name of a naive form
    points     how many were compared
    bound      on `worst`; None where answers state their own errors
    worst      the largest error in ulp beyond the condition number: |value - truth| over the larger of one ulp of the truth and
               what one ulp in every argument changes
    ulps       that error in ulp of the truth, whatever the condition
    condition  sum |x_i df/dx_i| / |f| there
    share      the largest |value - truth| over the error that the answer states; None where it states none
    stated     the largest stated error, in the same units as `worst`; None likewise
    violations how many points break the bound or the stated error
    at, value, truth   the arguments of the worst point, what came out there, what is right
    reason     why nothing was measured, "" if it was
    axes, map  names and values of the axes, and log2 of the error at each point of the grid, for the heat map
    """

    formula: str
    form: str
    source: str
    region: str
    precision: Precision
    points: int
    bound: float | None
    worst: float
    ulps: float
    condition: float
    share: float | None
    stated: float | None
    violations: int
    at: dict[str, float]
    value: float
    truth: str
    reason: str = ""
    axes: tuple[tuple[str, tuple[float, ...]], ...] = ()
    map: tuple[float, ...] = ()

    @property
    def visible(self) -> bool:
        """Whether a form that is not ours fails where everybody can see it."""
        return not self.worst < VISIBLE


@dataclass(frozen=True)
class Point:
    """The truth at one point, and one unit of error there: the larger of an ulp and of what the arguments' ulps do."""

    truth: ExactValue
    unit: Any
    ulp: Any


def measure(formula: Formula, points: int = POINTS) -> list[FormError]:
    """Return every form of a formula in every region and precision; `points` along an axis of a cheap one.

    `NotInstalledError` without what the truth is computed with: nothing can be said of any form then.
    """
    flint()
    n = max(2, round(points * formula.size))
    return [
        found
        for precision in formula.precisions
        for region in formula.regions
        for found in _measure(formula, region, precision, n)
    ]


def _measure(formula: Formula, region: HardRegion, precision: Precision, n: int) -> list[FormError]:
    along, arguments = region.grid(n, precision)
    count = len(next(iter(arguments.values())))
    rows = [{name: float(values[i]) for name, values in arguments.items()} for i in range(count)]
    axes = tuple((name, tuple(map(float, values))) for name, values in zip(region.axes, along, strict=True))
    forms: list[tuple[str, str, Evaluate, float | None]] = [(OURS, "", formula.ours, formula.bound)]
    forms += [(naive.name, naive.source, naive.evaluate, None) for naive in formula.naive]
    fault = ""
    try:
        truths = [_point(formula, row, precision) for row in rows]
    except NotInstalledError:  # a truth that needs something else: no form is to blame for that
        raise
    except Exception as error:
        if stop_behind(error) is not None:
            raise
        fault = f"no truth: {error}"
    found = []
    for name, source, evaluate, bound in forms:
        key: dict[str, Any] = {"formula": formula.name, "form": name, "source": source, "region": region.name}
        key |= {"precision": precision, "points": count, "bound": bound}
        outcome = {} if fault else _outcome(evaluate, arguments, truths, rows, bound)
        if "reason" in outcome or fault:  # one formula that fails costs no other its result
            outcome = {"worst": math.inf, "ulps": math.inf, "condition": 0.0, "share": None, "stated": None, **outcome}
            outcome |= {
                "violations": count,
                "at": rows[0],
                "value": math.nan,
                "truth": "",
                "reason": outcome.get("reason", fault),
            }
        found.append(FormError(**key, **outcome, axes=axes))
    return found


def _outcome(
    evaluate: Evaluate,
    arguments: dict[str, np.ndarray],
    points: list[Point],
    rows: list[dict[str, float]],
    bound: float | None,
) -> dict[str, Any]:
    """Return what one form came to, or the reason why it came to nothing."""
    try:
        with np.errstate(all="ignore"):
            answer = evaluate(**{name: values.copy() for name, values in arguments.items()})
    except Exception as error:
        if stop_behind(error) is not None:
            raise
        return {"reason": f"{type(error).__name__}: {error}"}
    return _compared(answer, points, rows, bound)


def _point(formula: Formula, row: dict[str, float], precision: Precision) -> Point:
    arb = flint().arb
    known = exactly(formula.truth, row, formula.condition)
    info = np.finfo(precision)
    if not known.value.is_finite():
        return Point(known, arb(0), arb(0))
    size = min(abs(float(known.value.mid())), float(info.max))
    place = np.dtype(precision).type(size)
    ulp = arb(
        float(
            place - np.nextafter(place, np.dtype(precision).type(0)) if size == float(info.max) else np.spacing(place)
        )
    )
    return Point(known, ulp.max(known.reach * arb(float(info.eps))), ulp)


def _compared(
    answer: np.ndarray | Reference, points: list[Point], rows: list[dict[str, float]], bound: float | None
) -> dict[str, Any]:
    """Return what `FormError` says of one form's values, one a point."""
    claimed = isinstance(answer, Reference)
    values = np.broadcast_to(answer.value if isinstance(answer, Reference) else answer, (len(points),))
    limits = np.finfo(values.dtype)
    errors = np.broadcast_to(answer.error, (len(points),)) if isinstance(answer, Reference) else None
    units, shares, stated = np.zeros((3, len(points)))
    for i, point in enumerate(points):
        off = _off(float(values[i]), point, float(limits.max))
        units[i] = _over(off, point.unit)
        if errors is not None:
            shares[i] = _over(off, flint().arb(float(errors[i]))) if math.isfinite(errors[i]) else 0.0
            stated[i] = _over(flint().arb(float(errors[i])), point.unit) if math.isfinite(errors[i]) else math.inf
    i = int(np.argmax(np.where(np.isnan(units), np.inf, units)))
    broken = (units > bound) if bound is not None else np.zeros(len(points), bool)
    if claimed:
        broken = broken | ~(shares <= 1)
    point, value = points[i], float(values[i])
    ulps = _over(_off(value, point, float(limits.max)), point.ulp)
    size = abs(point.truth.value)
    return {
        "worst": float(units[i]),
        "ulps": ulps,
        "condition": _over(point.truth.reach, size),
        "share": float(shares.max()) if claimed else None,
        "stated": float(stated.max()) if claimed else None,
        "violations": int(np.sum(broken)),
        "at": rows[i],
        "value": value,
        "truth": point.truth.value.str(50, radius=False),
        "map": tuple(map(float, np.round(np.log2(np.clip(units, 2.0**-10, 2.0**70)), 2))),
    }


def _off(value: float, point: Point, largest: float) -> Any:
    """Return |value - truth| as a ball; None for what is not a number, or infinite where the truth is not."""
    arb = flint().arb
    truth = point.truth.value
    if math.isnan(value):
        return None
    if not truth.is_finite():
        return arb(0) if math.isinf(value) and value > 0 else None
    if math.isinf(value):
        beyond = abs(truth) > arb(largest)
        return arb(0) if beyond and (truth > 0) == (value > 0) else None
    return abs(arb(value) - truth)


def _over(off: Any, unit: Any) -> float:
    """Return off/unit, 0 where nothing is off by anything, inf where it is off and has no unit."""
    if off is None:
        return math.inf
    if off.is_zero():
        return 0.0
    if unit.is_zero():
        return math.inf
    return min(float((off / unit).mid()), 1e300)
