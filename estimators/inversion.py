"""Rising functions inverted: Newton's method between bounds, each element for itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

MOST_STEPS = 100
"""Half of them would do if each were a halving."""

SAME = 2.3e-16
"""A relative step below which nothing changes."""


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
    left = np.arange(len(t))
    for _ in range(MOST_STEPS):
        if len(left) == 0:
            break
        now = t[left]
        off, slope = at(now, left)
        low[left], high[left] = np.where(off < 0, now, low[left]), np.where(off < 0, high[left], now)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            step = now - off / slope
        step = np.where((step >= low[left]) & (step <= high[left]), step, 0.5 * (low[left] + high[left]))
        t[left] = step
        moved = np.abs(step - now) / np.maximum(np.maximum(np.abs(now), unit), np.finfo(float).tiny)
        more = (moved > LAST) | (
            (moved > SAME) & (moved < 0.75 * before)
        )  # where rounding decides, steps no longer shrink
        left, before = left[more], moved[more]
    return t
