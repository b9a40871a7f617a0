"""Drawing one batch: moments of each replicate, of the squared deviations, the largest deviations, and the time it took."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.checks.streams import batch_generator
from fogproof.contracts import Estimator
from fogproof.study.cells import SOBOL_CALL, Cell, cells_of_text
from fogproof.study.drawn import numbers_of
from fogproof.study.fixed_work import time_fixed_work
from fogproof.study.plan import Batch
from fogproof.study.sobol import SobolSequence

COLUMNS = ("n", "mean", "m2", "m3", "m4", "low", "high", "at_low", "at_high", "bad")
"""Of a row of moments; `at_low` and `at_high` count the smallest and the largest value, `bad` what is not finite."""
TAIL = 64
"""Largest deviations a batch keeps."""
TAIL_SHARE = 64
"""They are at most one in so many of its samples."""
_SHORT = 2e-3
"""Seconds of a batch whose calls are timed in a loop: above, what a first call costs more is some per cent of it at most."""
_MOST_TURNS = 64
_AT_ONCE = 1 << 13
"""Realisations whose powers are summed at once."""


@dataclass(frozen=True, eq=False, slots=True)
class BatchResult:
    """What a batch leaves behind.

    index    of the batch
    moments  (replicates + 1, columns): one row a replicate, the last of (X - reference)^2 over the whole batch
    tail     the largest |X - reference|, rising
    cost     mean look-ups of a realisation, NaN where the estimator does not count them
    wall, cpu  seconds that its calls take; of this thread's processor time
    fixed    (sorts,) processor seconds of the fixed work beside it
    """

    index: int
    moments: np.ndarray
    tail: np.ndarray
    cost: float
    wall: float
    cpu: float
    fixed: np.ndarray


def run_batch(text: str, folder: str, batch: Batch, reference: float) -> BatchResult:
    """Draw a batch of the study with this text; the same wherever it runs."""
    return draw_batch(cells_of_text(text, folder)[batch.cell], batch, reference)


def draw_batch(cell: Cell, batch: Batch, reference: float) -> BatchResult:
    """Draw a batch of a cell."""
    estimator = cell.estimator(batch.size)
    rng = batch_generator(cell.study.seed, f"{cell.stream}/{batch.size}", batch.first, batch.start)
    clock = _Clock()
    if cell.points == "sobol":
        drawn = _with_sobol_points(cell, estimator, batch)
    else:
        # A call for each replicate, as a program makes it that wants one estimate: its fixed cost belongs to the estimate's time.
        drawn = [(estimator.draw(rng, batch.samples), batch.samples) for _ in range(batch.replicates)]
    wall, cpu = clock.read()
    # What the study itself does with the numbers is none of the estimator's time.
    numbers = [numbers_of(cell.name, draws, n) for draws, n in drawn]
    x, cost = np.concatenate([values for values, _ in numbers]), float(np.mean([cost for _, cost in numbers]))
    x = x.reshape(batch.replicates, batch.samples)
    del drawn, numbers
    with np.errstate(over="ignore", invalid="ignore"):
        own = moments_of(x)
        deviations = np.subtract(x, reference)
        tail = _largest(np.abs(deviations, out=deviations).ravel())
        squares = np.square(deviations, out=deviations).reshape(1, -1)
        moments = np.concatenate([own, moments_of(squares)])
    del x, deviations, squares
    if cpu < _SHORT:
        wall, cpu = _again(cell, estimator, batch, cpu)
    return BatchResult(batch.number, moments, tail, cost, wall, cpu, time_fixed_work())


def moments_of(x: np.ndarray) -> np.ndarray:
    """Return rows of `COLUMNS` for each row of x (rows, n); numbers that are not finite are counted and left out."""
    low, high = x.min(axis=1), x.max(axis=1)
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return np.concatenate([_row_with_gaps(row[np.isfinite(row)], len(row)) for row in x])
    n = np.full(len(x), float(x.shape[1]))
    # Rounding must not leave a constant with a variance.
    mean = np.where(low == high, low, np.clip(x.mean(axis=1), low, high))
    sums = np.zeros((3, len(x)))
    width = max(1, _AT_ONCE // len(x))
    for start in range(
        0, x.shape[1], width
    ):  # a stretch at a time: fresh arrays of the whole cost more than the arithmetic
        d = x[:, start : start + width] - mean[:, None]
        d2 = d * d
        sums[0] += d2.sum(axis=1)
        for total, factor in zip(sums[1:], (d, d2), strict=True):
            total += np.multiply(factor, d2, out=factor).sum(axis=1)
    ends = [np.count_nonzero(x == end[:, None], axis=1).astype(float) for end in (low, high)]
    return np.stack([n, mean, *sums, low, high, *ends, np.zeros(len(x))], axis=1)


def _row_with_gaps(finite: np.ndarray, n: int) -> np.ndarray:
    if len(finite):
        row = moments_of(finite[None])
    else:
        row = np.zeros((1, len(COLUMNS)))
        row[0, COLUMNS.index("low")], row[0, COLUMNS.index("high")] = np.inf, -np.inf
    row[0, -1] = n - len(finite)
    return row


def _largest(deviations: np.ndarray) -> np.ndarray:
    """Return the largest deviations, rising.

    The largest numbers of as many blocks as are kept are not below the least that is kept: whatever lies below those is left out
    before anything is sorted.
    """
    keep = min(TAIL, len(deviations) // TAIL_SHARE)
    if keep == 0:
        return np.empty(0)
    whole = len(deviations) // keep * keep
    least = deviations[:whole].reshape(keep, -1).max(axis=1).min()
    if not np.isfinite(deviations.max()):
        return _largest(deviations[np.isfinite(deviations)])
    return np.sort(deviations[deviations >= least])[-keep:]


class _Clock:
    """Seconds since it was made."""

    def __init__(self) -> None:
        self._wall, self._cpu = time.perf_counter(), time.thread_time()

    def read(self) -> tuple[float, float]:
        """Return those of the clock on the wall, and of this thread's processor time."""
        cpu = time.thread_time()
        return time.perf_counter() - self._wall, cpu - self._cpu


def _again(cell: Cell, estimator: Estimator, batch: Batch, cpu: float) -> tuple[float, float]:
    """Return the wall and processor time of a batch of short calls, made again in a loop of `_SHORT` about.

    The first calls after the study's own work find none of their code, data and memory near the processor, and the clock itself
    takes time: of a call of a few microseconds that would be most.
    """
    rng = np.random.default_rng(batch.number)
    turns = min(_MOST_TURNS, math.ceil(_SHORT / max(cpu, _SHORT / _MOST_TURNS)))
    clock = _Clock()
    if cell.points == "sobol":
        for _ in range(turns):
            _with_sobol_points(cell, estimator, batch)
    else:
        for _ in range(turns * batch.replicates):
            estimator.draw(rng, batch.samples)
    wall, cpu = clock.read()
    return wall / turns, cpu / turns


def _with_sobol_points(cell: Cell, estimator: Estimator, batch: Batch) -> list[tuple[Any, int]]:
    """Draw each replicate with a scrambling of its own; a batch inside a replicate goes on in its sequence. Return calls' draws."""
    dimensions = cell.dimensions
    assert dimensions is not None
    drawn = []
    for replicate in range(batch.first, batch.first + batch.replicates):
        scrambling = batch_generator(cell.study.seed, f"{cell.stream}/{batch.size}", replicate, 0)
        behind = batch_generator(cell.study.seed, f"{cell.stream}/{batch.size}", replicate, 1 + batch.start)
        sequence = SobolSequence(dimensions, scrambling, behind, batch.start)
        for start in range(0, batch.samples, SOBOL_CALL):
            n = min(SOBOL_CALL, batch.samples - start)
            drawn.append((estimator.draw(sequence.points(n), n), n))  # type: ignore[arg-type]
    return drawn
