"""A study taken apart into batches that can be drawn in any order, anywhere, and come out the same.

A batch belongs to a cell and a count; it holds several whole replicates where these are small, and a part of one replicate where it
is large. All batches follow from the study alone, and are not listed but counted: a study may have millions.
"""

from __future__ import annotations

import heapq
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fogproof.study.cells import Cell

TOGETHER = 2
"""Most replicates that a batch holds: cells take turns batch by batch, so that they meet the machine in the same moods."""
ROUNDS = 8
"""Turns that times are told apart by, with as many batches each: their scatter says how sure a time is."""


class Batch(NamedTuple):
    """A piece of work.

    number      its place in the study, from 0
    cell        index of its cell
    level       index of its count in the cell's counts
    size        samples, or steps, a replicate has
    first       its first replicate
    replicates  how many replicates it holds, or a part of
    start       where in its replicate it starts
    samples     how many realisations of each replicate
    """

    number: int
    cell: int
    level: int
    size: int
    first: int
    replicates: int
    start: int
    samples: int


class BatchPieces(NamedTuple):
    """The last four numbers of many batches, an array each."""

    first: np.ndarray
    replicates: np.ndarray
    start: np.ndarray
    samples: np.ndarray


@dataclass(frozen=True)
class BatchStretch:
    """The batches of one cell at one level.

    begin       number of the first of them
    realisations  of a replicate: its size, or 1 where the size counts steps
    replicates  in all
    together    replicates a batch, where they are whole
    parts       batches a replicate, where it is in parts; part samples each, but for the last
    """

    begin: int
    cell: int
    level: int
    size: int
    realisations: int
    replicates: int
    together: int
    parts: int
    part: int

    def __len__(self) -> int:
        return self.replicates * self.parts if self.parts > 1 else -(-self.replicates // self.together)

    @property
    def rounds(self) -> int:
        """Rounds its batches are drawn in."""
        return min(ROUNDS, len(self))

    def round_of(self, numbers: np.ndarray) -> np.ndarray:
        """Return the rounds that the batches of these numbers belong to."""
        return (numbers - self.begin) * self.rounds // len(self)

    def pieces(self, numbers: np.ndarray) -> BatchPieces:
        """Return what the batches of these numbers hold."""
        k = numbers - self.begin
        if self.parts == 1:
            first = k * self.together
            rest = np.minimum(self.together, self.replicates - first)
            return BatchPieces(first, rest, np.zeros_like(k), np.full_like(k, self.realisations))
        start = k % self.parts * self.part
        return BatchPieces(k // self.parts, np.ones_like(k), start, np.minimum(self.part, self.realisations - start))


@dataclass(frozen=True)
class Batches(Sequence[Batch]):
    """All batches of a study, by number."""

    stretches: tuple[BatchStretch, ...]

    def __len__(self) -> int:
        return self.stretches[-1].begin + len(self.stretches[-1])

    def in_turn(self) -> Iterator[Batch]:
        """Yield all batches in the order they are to be drawn in: every cell and count moves on together, small counts ahead.

        A study that ends early knows as much of one as of another, and a machine that slows down slows all of them.
        """
        yield from heapq.merge(*map(_numbered, self.stretches), key=self._turn)

    def _turn(self, batch: Batch) -> tuple[float, int, int]:
        stretch = self.stretches[self.stretch(batch.number)]
        return (batch.number - stretch.begin + 0.5) / len(stretch), batch.level, batch.cell

    def stretch(self, number: int) -> int:
        """Return the index of the stretch that a batch belongs to."""
        return bisect_right(self.stretches, number, key=lambda s: s.begin) - 1

    def __getitem__(self, number: int) -> Batch:  # type: ignore[override]  # nobody slices them
        stretch = self.stretches[self.stretch(number)]
        (piece,) = _each(stretch, np.array([number]))
        return piece

    def __iter__(self) -> Iterator[Batch]:
        for stretch in self.stretches:
            yield from _numbered(stretch)


def _numbered(stretch: BatchStretch) -> Iterator[Batch]:
    end = stretch.begin + len(stretch)
    for begin in range(stretch.begin, end, 10_000):
        yield from _each(stretch, np.arange(begin, min(begin + 10_000, end)))


def _each(stretch: BatchStretch, numbers: np.ndarray) -> Iterator[Batch]:
    for number, *piece in zip(numbers.tolist(), *(a.tolist() for a in stretch.pieces(numbers)), strict=True):
        yield Batch(number, stretch.cell, stretch.level, stretch.size, *piece)


def batches_of(cells: Sequence[Cell]) -> Batches:
    """Return all batches, small counts first."""
    stretches: list[BatchStretch] = []
    begin = 0
    for level in range(max(len(cell.counts) for cell in cells)):
        for cell in cells:
            if level < len(cell.counts):
                stretches.append(_stretch(begin, level, cell))
                begin += len(stretches[-1])
    return Batches(tuple(stretches))


def _stretch(begin: int, level: int, cell: Cell) -> BatchStretch:
    count, replicates = cell.counts[level], cell.replicates
    if cell.method.axis != "samples":
        return BatchStretch(begin, cell.index, level, count, 1, replicates, replicates // ROUNDS, 1, 1)
    most = cell.study.batch
    if cell.points == "sobol":
        most = 1 << (most.bit_length() - 1)  # a power of two: a stretch of Sobol points is balanced only then
    parts = -(-count // most)
    together = max(1, min(most // count, TOGETHER))
    return BatchStretch(begin, cell.index, level, count, count, replicates, together, parts, most)
