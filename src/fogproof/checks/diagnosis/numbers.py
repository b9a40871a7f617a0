"""What goes wrong with tables: indices off by some, tables read backwards, entries that are all alike or a few that are off."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting, of_points

_OFF = (1, -1, 2, -2)
_ENTRIES = 8  # that are off at most


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened to whole numbers, the simplest first."""
    n, x = setting.domain.measure, setting.contrast.x
    if np.isfinite(n):
        yield Hypothesis("uniform law", "these samples are uniform", lambda s, _: lambda i: np.ones(len(i)))
        yield Hypothesis(
            "sign convention", "these samples fit the table read backwards", lambda s, _: lambda i: s.p(n - 1 - i)
        )
    for off in _OFF:
        words = f"these samples fit the table with every index off by {off:+d}"
        yield Hypothesis("shifted", words, of_points(partial(_index, off=off, n=n)))
    if np.isfinite(n) and n <= 1 << 16:
        count = np.bincount(x.astype(int), minlength=int(n))
        p = setting.p(np.arange(n))
        expected = len(x) * p / max(p.sum(), 1e-300)
        worst = np.argsort(-np.abs(count - expected) / np.sqrt(np.maximum(expected, 1)))
        few = worst[: max(1, min(_ENTRIES, int(n) // 2))]
        factor = np.ones(int(n))
        factor[few] = (count[few] + 0.5) / np.maximum(expected[few], 0.5)
        named = ", ".join(str(i) for i in np.sort(few[:4]))
        yield Hypothesis(
            "few entries",
            f"these samples fit the table but for {len(few)} entries, among them {named}",
            lambda s, _: lambda i: s.p(i) * factor[np.clip(i, 0, n - 1).astype(int)],
        )


def _index(i: np.ndarray, off: int, n: float) -> np.ndarray:
    return np.asarray((i - off) % n if np.isfinite(n) else i - off)
