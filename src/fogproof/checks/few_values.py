"""Does every coordinate take as many different values as a continuous law does, or is one of them made of few bits?

A 16-bit cosine beside a fine azimuth never repeats a point: each coordinate of the domain's known law is looked at by itself.
"""

from __future__ import annotations

import numpy as np

from fogproof.checks.statistics.repeats import coarse_test
from fogproof.checks.subject import Subject
from fogproof.checks.verdict import Finding

_SPOILT = 1e-4  # of a law, in one step: as much as any check here may see
_NUDGED = 2048  # points that show what rounding does to a coordinate


def few_values_axes(subject: Subject) -> tuple[str, ...]:
    """Return the coordinates to look at: none on domains of one, whose points themselves would repeat, or with steps."""
    law = subject.domain.law(np.empty((0, *subject.domain.shape)))
    return () if subject.domain.shape == () or law.stepped else law.axes


def few_values(name: str, subject: Subject, axis: str, pilot: np.ndarray, points: np.ndarray, alpha: float) -> Finding:
    """Test one coordinate of points (n, k); the pilot's set the scale of the domain's law."""
    law = subject.domain.law(pilot)
    column = law.axes.index(axis)

    def coordinate(x: np.ndarray) -> np.ndarray:
        return law.coordinates(x, np.full((len(x), len(law.axes)), 0.5))[:, column]

    shown = points[:_NUDGED]
    place = coordinate(shown)
    moves = [np.abs(coordinate(moved) - place) for moved in subject.nudged(shown)]
    moves = [np.minimum(move, 1 - move) for move in moves]
    rounding = float(np.median(np.max(moves, axis=0))) if len(shown) else 0.0
    t = coordinate(points)
    if subject.precision == "float32" or _finer(t, subject.roundoff):
        rounding += 4 * subject.roundoff  # a cosine may have been rounded before it became a point
    return coarse_test(name, axis, t, rounding, subject.bits, alpha, subject.quasi_random)


def _finer(t: np.ndarray, roundoff: float) -> bool:
    """Return whether the steps of a rounded cosine are so small a part of the values (n,) that they spoil no law."""
    if len(t) == 0:
        return False
    low, high = np.quantile(t, [0.1, 0.9])
    return bool(2 * roundoff < _SPOILT * (high - low))
