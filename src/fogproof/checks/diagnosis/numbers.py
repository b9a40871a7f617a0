"""What goes wrong with tables: indices off by some, clamped or rounded, tables read backwards, few entries that are off."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting, known_number, of_points

_POWER = 0.05  # relative standard error of a power that is named
_POWERS = (0.25, 0.5, 0.8, 0.95, 1.05, 1.25, 2.0, 3.0)
_OFF = (1, -1, 2, -2)
_ENTRIES = 8  # that are off at most
_ONE_IN = 3  # entries of a table that are off at most: more are no few
_FEW = 5.0  # standard deviations of a count


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened to whole numbers, the simplest first."""
    n = setting.domain.measure
    if np.isfinite(n):
        yield Hypothesis("uniform law", "these samples are uniform", lambda s, _: lambda i: np.ones(len(i)))
        yield Hypothesis(
            "sign convention", "these samples fit the table read backwards", lambda s, _: lambda i: s.p(n - 1 - i)
        )
    yield Hypothesis(
        "wrong power",
        "these samples fit the table with its weights raised to the power {value}",
        lambda s, a: lambda i: np.maximum(s.p(i), 0.0) ** a,
        _POWERS,
        known_number({0.5: "the square roots of the weights", 2.0: "their squares"}, _POWER),
        null=1.0,
    )
    for off in _OFF:
        words = f"these samples fit the table with every index off by {off:+d}"
        yield Hypothesis("shifted", words, of_points(partial(_index, off=off, n=n)))
    if np.isfinite(n) and n > 2:
        last = int(n) - 1
        yield Hypothesis(
            "skipped entry", f"the last entry, {last}, never comes; the others fit the table", partial(_without, last)
        )
        words = f"the last entry, {last}, never comes, and {last - 1} comes for both: an index is clamped one too low"
        yield Hypothesis("clamped", words, partial(_gathered, last))
        words = f"the first entry and the last come half as often as others do: u (n - 1) is rounded, n = {last + 1}"
        yield Hypothesis("rounded index", words, partial(_halved, last))
    if np.isfinite(n) and n <= 1 << 16:
        yield from _few(setting, int(n))


def _few(setting: Setting, n: int) -> Iterator[Hypothesis]:
    """Yield that the entries are off whose counts stand out, if these are few.

    One at a time: what one entry has too much or too little, all others lack or share.
    """
    x = setting.contrast.x
    count = np.bincount(x.astype(int), minlength=n)
    p = setting.p(np.arange(n))
    expected = len(x) * p / max(p.sum(), 1e-300)
    others = np.ones(n, dtype=bool)
    while np.count_nonzero(~others) <= min(_ENTRIES, n // _ONE_IN):
        even = expected * count[others].sum() / max(expected[others].sum(), 1e-300)
        off = np.where(others, np.abs(count - even) / np.sqrt(np.maximum(even, 1)), 0.0)
        if off.max() <= _FEW:
            break
        others[np.argmax(off)] = False
    few = np.flatnonzero(~others)
    if not 0 < len(few) <= min(_ENTRIES, n // _ONE_IN):
        return
    factor = np.ones(n)
    factor[few] = (count[few] + 0.5) / np.maximum(even[few], 0.5)
    named = ", ".join(str(i) for i in few)
    told = f"{len(few)} entries, {named}" if len(few) > 1 else f"the entry {named}: {factor[few[0]]:.3g} times as often"
    yield Hypothesis(
        "few entries",
        f"these samples fit the table but for {told}",
        lambda s, _: lambda i: s.p(i) * factor[np.clip(i, 0, n - 1).astype(int)],
        fitted=len(few),
    )


def _without(last: int, setting: Setting, _: float) -> Density:
    return lambda i: np.where(i == last, 0.0, setting.p(i))


def _gathered(last: int, setting: Setting, _: float) -> Density:
    return lambda i: np.where(i == last, 0.0, setting.p(i) + (i == last - 1) * setting.p(np.full(len(i), last)))


def _halved(last: int, setting: Setting, _: float) -> Density:
    return lambda i: setting.p(i) * np.where((i == 0) | (i == last), 0.5, 1.0)


def _index(i: np.ndarray, off: int, n: float) -> np.ndarray:
    return np.asarray((i - off) % n if np.isfinite(n) else i - off)
