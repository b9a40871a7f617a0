"""How far a study is, and how long it will take: on stderr, where that is a terminal, and nowhere else."""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Sequence
from typing import Any

from fogproof.study.batches import BatchResult
from fogproof.study.cells import Cell
from fogproof.study.plan import Batch

_CALL, _SCRAMBLING = 3_000, 20_000
"""Realisations that take about as long as calling an estimator, and as scrambling Sobol points: for the time left alone."""


class Progress:
    """Counts batches, and foretells the rest from what a sample of each cell has taken so far."""

    def __init__(self, cells: Sequence[Cell], batches: Sequence[Batch], done: set[int], slots: int) -> None:
        self._cells = cells
        self._slots = max(slots, 1)
        self._left = [0.0] * len(cells)
        self._drawn = [0.0] * len(cells)
        self._took = [0.0] * len(cells)
        self._level = [-1] * len(cells)
        for batch in batches:
            if batch.number not in done:
                self._left[batch.cell] += self._work(batch)
        self._total, self._count = len(batches), len(done)
        self._bar: Any = None
        self._task: Any = None

    def __enter__(self) -> Progress:
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, MofNCompleteColumn, TextColumn
            from rich.progress import Progress as Bar

            left = TextColumn("{task.fields[left]}")
            columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), left)
            self._bar = Bar(*columns, console=Console(stderr=True), transient=True)
            self._bar.start()
            self._task = self._bar.add_task("starting", total=self._total, completed=self._count, left="")
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def advance(self, batch: Batch, result: BatchResult | None) -> None:
        """Count a batch that has been drawn, or given up."""
        work = self._work(batch)
        self._left[batch.cell] -= work
        self._count += 1
        if result is not None:
            if batch.level > self._level[batch.cell]:  # small batches are mostly overhead: the last count tells more
                self._level[batch.cell], self._drawn[batch.cell], self._took[batch.cell] = batch.level, 0.0, 0.0
            self._drawn[batch.cell] += work
            self._took[batch.cell] += result.wall
        if self._bar is not None:
            name = f"{self._cells[batch.cell].scene.name}: {self._cells[batch.cell].name}"
            self._bar.update(self._task, completed=self._count, description=name[:32], left=f"about {self.left()} left")

    def left(self) -> str:
        """Return the time left; a cell that has not been met yet is taken to be as slow as most."""
        known = [took / drawn for took, drawn in zip(self._took, self._drawn, strict=True) if drawn]
        usual = statistics.median(known) if known else 0.0
        each = [took / drawn if drawn else usual for took, drawn in zip(self._took, self._drawn, strict=True)]
        seconds = sum(rate * work for rate, work in zip(each, self._left, strict=True)) / self._slots
        return time.strftime("%M:%S" if seconds < 3600 else "%H:%M:%S", time.gmtime(max(seconds, 0)))

    def _work(self, batch: Batch) -> float:
        """Return a batch's work in realisations, or steps, with what the calls and the scrambling of points cost beside them."""
        cell = self._cells[batch.cell]
        each = batch.size if cell.method.axis == "steps" else batch.samples
        scrambled = batch.replicates if cell.points == "sobol" else 0
        return float(each * batch.replicates + _CALL * batch.replicates + _SCRAMBLING * scrambled)
