"""Rising functions inverted: Newton's method between bounds, each element for itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

MOST_STEPS = 100
"""Half of them would do if each were a halving."""

LAST, SAME = 1e-9, 2.3e-16
"""Relative steps: one below the first ends it unless it shrinks as Newton's do, one below the second always."""


def inverted(
    at: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]],
    start: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    unit: float = 0.0,
) -> np.ndarray:
    """Return where rising functions are 0, (n,).

    at     (t (k,), numbers of the elements (k,)) -> (values, slopes)
    start  (n,) in [low, high], which are bounds of what is sought
    unit   steps are relative to |t|, or to this where that is smaller
    """
    t, low, high = start.copy(), low.copy(), high.copy()
    left, before = np.arange(len(t)), np.full(len(t), np.inf)
    for _ in range(MOST_STEPS):
        if len(left) == 0:
            break
        now = t[left]
        off, slope = at(now, left)
        low[left], high[left] = np.where(off < 0, now, low[left]), np.where(off < 0, high[left], now)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            step = now - off / slope
        # A step back to a bound is one: halving would leave a root that rounding has met.
        step = np.where((step >= low[left]) & (step <= high[left]), step, 0.5 * (low[left] + high[left]))
        t[left] = step
        moved = np.abs(step - now) / np.maximum(np.maximum(np.abs(now), unit), np.finfo(float).tiny)
        shrinks = moved < 0.75 * before  # where rounding decides, steps no longer do
        more = (moved > LAST) | ((moved > SAME) & shrinks)
        left, before = left[more], moved[more]
    return t
