"""From stored batches to moments: merged in the order of the study, never in the order of arrival.

All sums run over arrays whose order is fixed, so the same batches give the same bits whoever drew them, and when.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, islice

import numpy as np

from fogproof.checks.statistics.moments import Moments
from fogproof.study.batches import COLUMNS, TAIL_SHARE
from fogproof.study.cells import Cell
from fogproof.study.fixed_work import over_fixed_work
from fogproof.study.plan import Batches, BatchStretch
from fogproof.study.stored_batches import Row

_N, _MEAN, _M2, _M3, _M4, _LOW, _HIGH, _AT_LOW, _AT_HIGH, _BAD = range(len(COLUMNS))
_AT_ONCE = 10_000
"""Batches that are read before they are packed into arrays: as objects of Python's they take several times the memory."""
_TAIL_KEPT = 2048


@dataclass(frozen=True, eq=False)
class Level:
    """What was drawn of a cell at one count.

    rows        (replicates, columns) moments of the complete replicates
    replicates  how many the study asks for
    squares     (columns,) moments of (X - reference)^2
    tail        the largest |X - reference|, all of them down to the smallest one here
    cost        mean look-ups of a realisation, NaN where they are not counted
    seconds     (rounds,) processor time of one whole estimate, the fixed cost of its calls included; NaN where none was drawn
    wall        [s] a realisation, the median over the batches
    batches     how many there are
    cpu_total   [s] of all of them
    over_fixed  (groups, columns) logarithms of one estimate's time over that of fixed work, see `over_fixed_work`
    """

    count: int
    rows: np.ndarray
    replicates: int
    squares: np.ndarray
    tail: np.ndarray
    cost: float
    seconds: np.ndarray
    wall: float
    batches: int
    cpu_total: float
    over_fixed: np.ndarray

    @property
    def complete(self) -> bool:
        """Whether no replicate is missing."""
        return len(self.rows) == self.replicates

    @property
    def bad(self) -> int:
        """Realisations that were not finite."""
        return int(self.rows[:, _BAD].sum())


def levels_of(rows: Iterable[Row], cells: Sequence[Cell], batches: Batches) -> list[list[Level]]:
    """Return the levels of each cell, one for each count of which anything was drawn."""
    levels: list[list[Level]] = [[] for _ in cells]
    begins = [stretch.begin for stretch in batches.stretches]
    for number, own in groupby(rows, lambda row: bisect_right(begins, row[0])):
        stretch = batches.stretches[number - 1]
        levels[stretch.cell].append(_level(own, stretch))
    return levels


@dataclass(frozen=True, eq=False)
class _Handful:
    """A number of stored batches as arrays.

    rows          (.., columns) the moments of replicates or parts of them, and `replicate` which
    squares       (columns,) moments of (X - reference)^2
    realisations, costs, cpu, wall  (batches,)
    fixed         (batches, sorts)
    round         (batches,) that they were drawn in
    tail          the largest |X - reference| down to `least`, the largest of the batches' smallest
    tails_known   whether every batch that keeps a tail has one
    """

    rows: np.ndarray
    replicate: np.ndarray
    squares: np.ndarray
    realisations: np.ndarray
    costs: np.ndarray
    cpu: np.ndarray
    wall: np.ndarray
    fixed: np.ndarray
    round: np.ndarray
    tail: np.ndarray
    least: float
    tails_known: bool


def _level(own: Iterator[Row], stretch: BatchStretch) -> Level:
    """Return the level that some rows belong to; a few at a time, because there may be very many."""
    parts: list[_Handful] = []
    while group := list(islice(own, _AT_ONCE)):
        parts.append(_handful(group, stretch))
    starts = np.flatnonzero(np.diff(np.concatenate([part.replicate for part in parts]), prepend=-1))
    squares = merged(np.stack([part.squares for part in parts]), np.array([0]))[0]
    names = ("realisations", "costs", "cpu", "wall", "fixed", "round")
    n, costs, cpu, wall, fixed, rounds = (np.concatenate([getattr(p, name) for p in parts]) for name in names)
    took, drawn = (np.bincount(rounds, weights, stretch.rounds) for weights in (cpu, n))
    known, least = all(part.tails_known for part in parts), max(part.least for part in parts)
    tail = np.sort(np.concatenate([part.tail for part in parts]))
    rows = np.concatenate([part.rows for part in parts])
    parts.clear()
    rows = merged(rows, starts)
    whole = rows[:, _N] + rows[:, _BAD] == stretch.realisations
    return Level(
        stretch.size,
        rows if whole.all() else rows[whole],
        stretch.replicates,
        squares,
        tail[np.searchsorted(tail, least) :][-_TAIL_KEPT:] if known else np.empty(0),
        float(np.sum(costs * n) / n.sum()),
        np.divide(stretch.realisations * took, drawn, out=np.full(stretch.rounds, np.nan), where=drawn > 0),
        float(np.median(wall / n)),
        len(n),
        float(cpu.sum()),
        over_fixed_work(stretch.realisations * cpu / n, fixed),
    )


def _handful(group: list[Row], stretch: BatchStretch) -> _Handful:
    pieces = stretch.pieces(np.array([row[0] for row in group]))
    table = np.frombuffer(b"".join(row[1] for row in group)).reshape(-1, len(COLUMNS))
    sizes = pieces.replicates
    last = np.cumsum(sizes + 1) - 1  # the row of squares ends each batch
    own = np.ones(len(table), bool)
    own[last] = False
    first = np.repeat(pieces.first, sizes)
    within = np.arange(len(first)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    realisations = sizes * pieces.samples
    tail = np.frombuffer(b"".join(row[2] for row in group))
    lengths = np.array([len(row[2]) // 8 for row in group])
    starts = (np.cumsum(lengths) - lengths)[lengths > 0]
    least = float(tail[starts].max()) if len(starts) else 0.0
    largest = tail[tail >= least]
    if len(largest) > _TAIL_KEPT:
        largest = np.partition(largest, len(largest) - _TAIL_KEPT)[-_TAIL_KEPT:]
    return _Handful(
        table[own],
        first + within,
        merged(table[last], np.array([0]))[0],
        realisations,
        np.array([np.nan if row[3] is None else row[3] for row in group]),
        np.array([row[5] for row in group]),
        np.array([row[4] for row in group]),
        np.frombuffer(b"".join(row[6] for row in group)).reshape(len(group), -1),
        stretch.round_of(np.array([row[0] for row in group])),
        largest,
        least,
        bool(np.all(lengths[realisations >= TAIL_SHARE] > 0)) and len(starts) > 0,
    )


def merged(rows: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Return the rows of moments of each stretch of rows that begins at `starts` (Pébay 2008, about the common mean)."""
    if len(rows) == 0:
        return rows
    lengths = np.diff(starts, append=len(rows))
    n_i = rows[:, _N]
    n = np.add.reduceat(n_i, starts)
    low, high = np.minimum.reduceat(rows[:, _LOW], starts), np.maximum.reduceat(rows[:, _HIGH], starts)
    mean = np.add.reduceat(n_i * rows[:, _MEAN], starts) / np.maximum(n, 1)
    mean = np.where(n > 0, np.clip(mean, low, high), 0.0)
    d = np.where(n_i > 0, rows[:, _MEAN] - np.repeat(mean, lengths), 0.0)
    with np.errstate(over="ignore", invalid="ignore"):  # `judgement.out_of_range` refuses such numbers by name
        d2 = d * d
        m2 = rows[:, _M2] + n_i * d2
        m3 = rows[:, _M3] + 3 * d * rows[:, _M2] + n_i * d2 * d
        m4 = rows[:, _M4] + 4 * d * rows[:, _M3] + 6 * d2 * rows[:, _M2] + n_i * d2 * d2
        sums = [np.add.reduceat(m, starts) for m in (m2, m3, m4)]
    at_low = np.add.reduceat(np.where(rows[:, _LOW] == np.repeat(low, lengths), rows[:, _AT_LOW], 0.0), starts)
    at_high = np.add.reduceat(np.where(rows[:, _HIGH] == np.repeat(high, lengths), rows[:, _AT_HIGH], 0.0), starts)
    bad = np.add.reduceat(rows[:, _BAD], starts)
    return np.stack([n, mean, *sums, low, high, at_low, at_high, bad], axis=1)


def pooled(rows: np.ndarray) -> Moments:
    """Return the moments of all rows together."""
    if len(rows) == 0:
        return Moments()
    row = merged(rows, np.array([0]))[0].tolist()
    n, low, high = int(row[_N]), row[_LOW], row[_HIGH]
    if low == high:
        values: dict[float, int] | None = {low: n}
    else:
        two = row[_AT_LOW] + row[_AT_HIGH] == n
        values = {low: int(row[_AT_LOW]), high: int(row[_AT_HIGH])} if two else None
    return Moments(n, row[_MEAN], row[_M2], row[_M3], row[_M4], low, high, values)
