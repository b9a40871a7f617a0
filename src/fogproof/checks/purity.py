"""Is a sampler the function of its uniforms that it claims to be?

`sample(u)` must give every row of u the same answer whenever it is asked, in whatever order and in whatever company: asked twice,
with the rows shuffled, and in calls of 1, 10 and 1000 rows. It must leave u as it was, and it must use it. What fails here is
hidden state, a law that depends on the size of a call, or rows that see each other; all statistics of one large call can be perfect
all the same.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject
from fogproof.checks.verdict import Finding
from fogproof.contracts import Draw
from fogproof.errors import SubjectError

_GENERATOR = "function of its generator"
_HEARD, _TELLING = 256, 8  # samples, and different ones among them that chance does not repeat
_ROWS = 1000  # asked about again
_CALLS = {1: 16, 10: 8, _ROWS: 1}  # rows of a call: how many such calls
_TOLERANCE = {
    "float64": 1e-7,
    "float32": 2.0**-12,
}  # relative: vectorised code may round, or stop iterating, a little differently
_LAST = {"float64": 2.0**-46, "float32": 2.0**-20}  # relative: some units in the last place
_AGAIN = 16  # calls of the same rows, where something differs
_FEW = 0.01  # of the rows: a rounding may tip a choice


def purity(subject: Subject, u: np.ndarray) -> list[Finding]:
    """Ask for the rows of u (n, dimensions) in several ways and return what is found, all without statistics."""
    kept = u.copy()
    draw = subject.draw_at(u)
    if not np.array_equal(u, kept):
        column = int(np.argmax(np.any(u != kept, axis=0)))
        message = f"sample(u) writes into column {column} of u, which belongs to its caller; copy it first"
        return [Finding("function of its uniforms", "rejected", message, cause="writes into its uniforms")]
    for message, cause in _faults(subject, kept, draw):
        return [Finding("function of its uniforms", "rejected", message, cause=cause)]
    sizes = ", ".join(str(size) for size in _CALLS)
    message = f"{min(_ROWS, len(u))} rows give the same answers twice, shuffled, and in calls of {sizes}"
    return [Finding("function of its uniforms", "not rejected", f"{message}{_idle(subject, kept, draw)}")]


def heeds_generator(subject: Subject, seed: int) -> Finding:
    """Return whether a sampler that draws its own uniforms gives other samples for another generator."""
    first, second = (subject.draw(batch_generator(seed, "purity", 0, index), _HEARD).x for index in range(2))
    if np.array_equal(first, second, equal_nan=True) and len(np.unique(first, axis=0)) >= _TELLING:
        message = f"two generators give the same {_HEARD} samples: the one that sample(rng, n) is given is ignored"
        return Finding(_GENERATOR, "rejected", message, cause="ignores its generator")
    return Finding(
        _GENERATOR, "not rejected", f"two generators give different samples, or one of fewer than {_TELLING} points"
    )


def _faults(subject: Subject, u: np.ndarray, draw: Draw) -> Iterator[tuple[str, str]]:
    """Yield what is wrong, the most telling first, as a message and a cause."""
    others = subject.draw_at(np.ascontiguousarray(0.5 * u[::-1]))  # whatever state there is, this changes it
    field, share = _differs(draw, subject.draw_at(u.copy()), subject.precision)
    if field:
        yield f"the same uniforms give another {field} the second time ({share:.0%} of the rows)", "hidden state"
    column = draw.x.reshape(len(u), -1)[:, 0]
    column = column[~np.isnan(column)]
    if np.any(column != column[:1]) and np.array_equal(draw.x, others.x, equal_nan=True):
        yield "other uniforms give the same samples: u is ignored", "ignores its uniforms"
    first = u[:_ROWS]
    order = np.random.default_rng(0).permutation(len(first))
    part = subject.draw_at(first.copy())
    field, share = _differs(rows_of(part, order), subject.draw_at(first[order]), subject.precision)
    if share > _FEW:
        yield from _unsteady(subject, first)
        yield f"the {field} of a row depends on its place among the others ({share:.0%})", "order of the rows"
    for size, calls in sorted(_CALLS.items(), reverse=True):
        found = [_in_a_call(subject, u, draw, start, size) for start in range(0, min(size * calls, len(u)), size)]
        field, share = found[int(np.argmax([share for _, share in found]))]
        if share > _FEW:
            yield from _unsteady(subject, u[:size])
            yield (
                f"in calls of {size} rows {field}, unlike in one of {len(u)} ({share:.0%} of them)",
                "size of the call",
            )


def _unsteady(subject: Subject, u: np.ndarray) -> Iterator[tuple[str, str]]:
    """Yield that calls of the very same rows differ: state that comes back after some calls hides from a second one."""
    try:
        first, *others = (subject.draw_at(u.copy()) for _ in range(_AGAIN))
    except SubjectError:
        return
    for call, other in enumerate(others, 2):
        field, share = _differs(first, other, subject.precision)
        if share > _FEW:
            yield f"call {call} of the same rows gives another {field} ({share:.0%} of the rows)", "hidden state"
            return


def _in_a_call(subject: Subject, u: np.ndarray, draw: Draw, start: int, size: int) -> tuple[str, float]:
    """Return what some rows do by themselves and not among all, and in which share of them."""
    rows = slice(start, start + size)
    try:
        field, share = _differs(rows_of(draw, rows), subject.draw_at(u[rows].copy()), subject.precision)
    except SubjectError as error:
        return f"{error}", 1.0
    return f"a row gives another {field}", share


def _idle(subject: Subject, u: np.ndarray, draw: Draw) -> str:
    """Return in words which columns of u change nothing; that is allowed, but seldom meant."""
    first, idle = rows_of(draw, slice(0, _ROWS)), []
    if u.shape[1] == 1 or u.shape[1] > 64:
        return ""
    for column in range(u.shape[1]):
        moved = u[:_ROWS].copy()
        moved[:, column] = np.roll(moved[:, column], 1)
        if _differs(first, subject.draw_at(moved), subject.precision)[1] == 0:
            idle.append(str(column))
    if not idle:
        return ""
    return f"; of the columns of u, no sample depends on: {', '.join(idle)}"


def rows_of(draw: Draw, rows: np.ndarray | slice) -> Draw:
    """Return some rows of a draw."""
    x, *others = (None if part is None else part[rows] for part in draw)
    assert x is not None
    return Draw(x, *others)


def _differs(a: Draw, b: Draw, precision: str) -> tuple[str, float]:
    """Return the part of two draws that differs most by more than rounding, and in which share of the rows."""
    worst = ("", 0.0)
    for name, one, two in zip(Draw._fields, a, b, strict=True):
        if (one is None) != (two is None):
            return name, 1.0
        if one is None or two is None or not len(one):
            continue
        if one.shape != two.shape:
            return name, 1.0
        first, second = one.reshape(len(one), -1).astype(float), two.reshape(len(two), -1).astype(float)
        same = first == second
        if same.all():  # the usual answer, for which nobody needs to know how much would be allowed
            continue
        same |= np.isnan(first) & np.isnan(second)
        with np.errstate(invalid="ignore"):
            same |= np.abs(first - second) <= _allowed(first, precision)
        share = float(np.mean(~same.all(axis=1)))
        if share > worst[1]:
            worst = (name, share)
    return worst


def _allowed(values: np.ndarray, precision: str) -> np.ndarray:
    """Return (n, k) what rounding may change: relative to how far each column's values lie apart, wherever they lie."""
    known = np.where(np.isfinite(values), values, np.nan)
    with np.errstate(all="ignore"):
        middle = _middle(known)
        spread = _middle(np.abs(known - middle))
        middle, scale = np.where(spread > 0, middle, 0.0), np.where(spread > 0, spread, np.abs(middle))
        return np.asarray(_TOLERANCE[precision] * (np.abs(values - middle) + scale) + _LAST[precision] * np.abs(values))


def _middle(values: np.ndarray) -> np.ndarray:
    """Return (k,) the median of each column without its NaN, 0 where there is nothing else.

    NumPy's own goes through masked arrays, which takes a millisecond, and most of a small check.
    """
    count = np.sum(~np.isnan(values), axis=0)
    pair = np.stack([np.maximum(count - 1, 0) // 2, np.minimum(count // 2, len(values) - 1)])
    ordered = np.sort(values, axis=0)  # NaN come last
    return np.nan_to_num(np.take_along_axis(ordered, pair, axis=0).mean(axis=0))
