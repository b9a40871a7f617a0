"""Fixed work that is timed beside every batch: how fast the machine is just then, whatever the estimators are.

A machine is faster on one day than on another, and not to everything alike: what is interpreted, what is calculated and what moves
memory about slow down each by a factor of its own. Times over the time of fixed work can be compared between two runs, of one
estimator as of many, as far as the three sorts agree.
"""

from __future__ import annotations

import itertools
import math
import time
from typing import Any

import numpy as np

VERSION = 1
"""Raised with whatever changes what the work takes: times over that of another version are not compared."""
SORTS = ("interpreted", "arithmetic", "memory")
COLUMNS = (*SORTS, "all")
"""Of times over those of the work: the last is the geometric mean."""
_TURNS = 3
_X = np.linspace(0, 1, 2048)
_LARGE = 1 << 15
GROUPS = 32
"""Stretches of batches that are told apart, at most."""
_TRIMMED = 0.2
"""Share of the groups that is left out at either end: processes that come between make some batches much slower."""


def time_fixed_work() -> np.ndarray:
    """Return the processor time [s] of each of `SORTS`, (3,): some 20 us each.

    The least of a few turns, after one that brings code and data near the processor: what comes between is no part of it.
    """
    least = []
    for work in (_interpreted, _arithmetic, _memory):
        work()
        clock = [time.thread_time()]
        for _ in range(_TURNS):
            work()
            clock.append(time.thread_time())
        least.append(min(end - start for start, end in itertools.pairwise(clock)))
    return np.array(least)


def over_fixed_work(seconds: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """Return logarithms of times (batches,) over those of the work beside them (batches, sorts): (groups, columns).

    Each is the median of one of `GROUPS` stretches of batches.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log(seconds[:, None] / fixed)
    logs = logs[np.isfinite(logs).all(axis=1)]  # a clock that saw no time pass says nothing
    logs = np.column_stack([logs, logs.mean(axis=1)])
    groups = [np.median(part, axis=0) for part in np.array_split(logs, GROUPS) if len(part)]
    return np.array(groups).reshape(-1, len(COLUMNS))


def summed_up(logs: np.ndarray) -> dict[str, Any] | None:
    """Return what a record keeps of `over_fixed_work`: trimmed means (Yuen 1974), None of less than 2 groups."""
    n = len(logs)
    cut = int(_TRIMMED * n)
    kept = n - 2 * cut
    if kept < 2:
        return None
    rising = np.sort(logs, axis=0)
    spread = np.clip(rising[:, -1], rising[cut, -1], rising[n - 1 - cut, -1]).var(ddof=1)  # winsorized
    ratios = np.exp(rising[cut : n - cut].mean(axis=0)).tolist()
    stderr = math.sqrt((n - 1) * float(spread) / (kept * (kept - 1)))
    return {"version": VERSION, **dict(zip(COLUMNS, ratios, strict=True)), "stderr": stderr, "freedom": kept - 1}


def _interpreted() -> float:
    x, total = 0.3, 0.0
    for k in range(300):
        x = 3.7 * x * (1 - x)
        total += x if x > 0.5 else 1 / (k + x)
    return total


def _arithmetic() -> float:
    y = np.exp(_X)
    return float(np.sin(y, out=y).sum())


def _memory() -> float:
    x = np.ones(_LARGE)
    x *= 2.0
    return float(x.sum())
