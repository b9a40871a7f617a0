"""From stored batches to moments: merged in the order of the study, never in the order of arrival.

All sums run over arrays whose order is fixed, so the same batches give the same bits whoever drew them, and when.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from fogproof.checks.means import Moments
from fogproof.study.batches import COLUMNS, TAIL_SHARE
from fogproof.study.cells import Batch, Cell
from fogproof.study.store import Row

_N, _MEAN, _M2, _M3, _M4, _LOW, _HIGH, _AT_LOW, _AT_HIGH, _BAD = range(len(COLUMNS))


@dataclass(frozen=True, eq=False)
class Level:
    """What was drawn of a cell at one count.

    rows        (replicates, columns) moments of the complete replicates
    replicates  how many the study asks for
    squares     (columns,) moments of (X - reference)^2
    tail        the largest |X - reference|, all of them down to the smallest one here
    cost        mean look-ups of a realisation, NaN where they are not counted
    cpu, wall   (batches,) seconds a realisation
    cpu_total   [s] of all batches
    """

    count: int
    rows: np.ndarray
    replicates: int
    squares: np.ndarray
    tail: np.ndarray
    cost: float
    cpu: np.ndarray
    wall: np.ndarray
    cpu_total: float

    @property
    def complete(self) -> bool:
        """Whether no replicate is missing."""
        return len(self.rows) == self.replicates

    @property
    def bad(self) -> int:
        """Realisations that were not finite."""
        return int(self.rows[:, _BAD].sum())


def levels_of(rows: Iterable[Row], cells: Sequence[Cell], batches: Sequence[Batch]) -> list[list[Level]]:
    """Return the levels of each cell, one for each count of which anything was drawn."""
    levels: list[list[Level]] = [[] for _ in cells]
    group: list[Row] = []
    key: tuple[int, int] | None = None
    for row in rows:
        batch = batches[row[0]]
        if (batch.cell, batch.level) != key:
            _finish(group, cells, batches, levels)
            group, key = [], (batch.cell, batch.level)
        group.append(row)
    _finish(group, cells, batches, levels)
    return levels


def _finish(group: list[Row], cells: Sequence[Cell], batches: Sequence[Batch], levels: list[list[Level]]) -> None:
    if group:
        cell = cells[batches[group[0][0]].cell]
        levels[cell.index].append(_level(group, cell, [batches[row[0]] for row in group]))


def _level(group: list[Row], cell: Cell, batches: list[Batch]) -> Level:
    table = np.frombuffer(b"".join(row[1] for row in group)).reshape(-1, len(COLUMNS))
    sizes = np.array([batch.replicates for batch in batches])
    last = np.cumsum(sizes + 1) - 1  # the row of squares ends each batch
    own = np.ones(len(table), bool)
    own[last] = False
    first = np.repeat([batch.first for batch in batches], sizes)
    within = np.arange(len(first)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    replicate = first + within
    starts = np.flatnonzero(np.diff(replicate, prepend=-1))
    rows = merged(table[own], starts)
    count = batches[0].count
    wanted = count if cell.method.axis == "samples" else 1
    rows = rows[rows[:, _N] + rows[:, _BAD] == wanted]
    per_draw = sizes * np.array([batch.samples for batch in batches])
    costs = np.array([np.nan if row[3] is None else row[3] for row in group])
    cpu, wall = np.array([row[5] for row in group]), np.array([row[4] for row in group])
    squares = merged(table[last], np.array([0]))[0]
    tail = _complete_tail([np.frombuffer(row[2]) for row in group], per_draw)
    cost = float(np.sum(costs * per_draw) / per_draw.sum())
    return Level(count, rows, cell.replicates, squares, tail, cost, cpu / per_draw, wall / per_draw, float(cpu.sum()))


def _complete_tail(tails: list[np.ndarray], sizes: np.ndarray) -> np.ndarray:
    """Return the part of the batches' tails that is known whole: what exceeds the smallest number each of them kept."""
    if not all(len(tail) for tail, n in zip(tails, sizes, strict=True) if n >= TAIL_SHARE):
        return np.empty(0)
    known = [tail for tail in tails if len(tail)]
    if len(known) < len(tails):
        return np.empty(0)
    least = max(tail[0] for tail in known)
    together = np.sort(np.concatenate(known))
    return together[np.searchsorted(together, least) :]


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
