"""After how many points does a stream begin anew: a sequence that is used up, or one that every call begins?"""

from __future__ import annotations

import numpy as np

from fogproof.checks.diagnosis.patience import OutOfTimeError
from fogproof.checks.statistics.repeats import KEPT, fingerprints
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject

_FIRST = 64  # points that are looked for again
_ALL = 0.99  # of the points: some may be lost


def repeated(subject: Subject, samples: int, seed: int) -> str:
    """Return in words after how many points all of them come again, "" if they do not in two calls of up to `samples`."""
    n = (min(samples, KEPT) - 1) | 1  # odd: no sequence ends there by chance
    try:
        first, second = (
            fingerprints(subject.draw(batch_generator(seed, "periods", 0, call), n).x) for call in range(2)
        )
    except OutOfTimeError:
        return ""
    both = np.concatenate([first, second])
    period = _period(first)
    if period and _comes_again(both, period):
        return f"the sequence begins anew after {period} points: a longer one is needed"
    if period:
        return f"a call of {n} points repeats itself after {period} of them"
    if _comes_again(both, n):
        return f"every call begins the sequence anew: the first {n} points of two calls are the same"
    period = _period(both)
    return f"the sequence begins anew after {period} points: a longer one is needed" if period else ""


def _period(prints: np.ndarray) -> int:
    """Return after how many points (n,) they come again, 0 if they do not: told by when the first ones do."""
    lags = [np.flatnonzero(prints[i + 1 :] == prints[i])[:1] + 1 for i in range(min(_FIRST, len(prints)))]
    values, counts = np.unique(np.concatenate(lags), return_counts=True)
    if not len(values):
        return 0
    lag = int(values[np.argmax(counts)])
    return lag if _comes_again(prints, lag) else 0


def _comes_again(prints: np.ndarray, lag: int) -> bool:
    return bool(np.mean(prints[lag:] == prints[:-lag]) > _ALL)
