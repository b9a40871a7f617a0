"""Cells and batches: a study taken apart into pieces that can be drawn in any order, anywhere, and come out the same.

A cell is an estimator in a scene with one kind of points. A batch belongs to a cell and a count; it holds several whole replicates
where these are small, and a part of one replicate where it is large. The list of batches follows from the study alone.
"""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np

from fogproof.contracts import Estimator, Reference
from fogproof.errors import FogproofError, InvalidInputError, UnsupportedError
from fogproof.study.files import Study, StudyScene, study_of
from fogproof.study.methods import Method, name_of
from fogproof.study.sobol import SobolSequence

Points = Literal["random", "sobol"]
_BUILDING = threading.RLock()
"""Large modules are loaded by the first estimator that needs them, which two threads at a time may not do."""
EXACT_CALLS = 1024
"""Realisations of an exact estimator: it needs one, but its time is measured."""
MARCHES = 4
"""Realisations of each march: they are alike, but their time is measured."""
SOBOL_CALL = 1 << 14
"""Sobol points an estimator is given at once: it works in blocks, and must see all of a block's points together."""


@dataclass(frozen=True, slots=True)
class Batch:
    """A piece of work.

    index       its place in the study, from 0
    cell        index of its cell
    level       index of its count in the cell's counts
    count       samples a replicate has
    first       its first replicate
    replicates  how many replicates it holds, or a part of
    start       where in its replicate it starts
    samples     how many of each replicate
    """

    index: int
    cell: int
    level: int
    count: int
    first: int
    replicates: int
    start: int
    samples: int


@dataclass(frozen=True, eq=False)
class Cell:
    """An estimator in a scene, with random or Sobol points."""

    index: int
    scene: StudyScene
    method: Method
    points: Points
    study: Study
    _made: dict[int, Estimator] = field(default_factory=dict, repr=False)

    @property
    def name(self) -> str:
        """The estimator's name, unique in its scene."""
        return name_of(self.method) + (" + sobol" if self.points == "sobol" else "")

    @property
    def stream(self) -> str:
        """What names its random numbers."""
        return f"study/{self.scene.name}/{self.name}"

    @property
    def counts(self) -> tuple[int, ...]:
        """Samples, or steps, of each level; powers of two for Sobol points, one for what needs no more."""
        if self.method.axis == "nothing":
            return (1,)
        if self.points == "sobol":
            return tuple(sorted({1 << max(0, round(float(np.log2(n)))) for n in self.study.samples}))
        return self.study.samples

    @property
    def replicates(self) -> int:
        """Independent estimates at each count."""
        return {"samples": self.study.replicates, "steps": MARCHES, "nothing": EXACT_CALLS}[self.method.axis]

    @cached_property
    def reference(self) -> Reference:
        """What the oracle says of the scene: one finite number."""
        reference = self.scene.reference()
        if np.ndim(reference.value) or not np.isfinite(reference.value):
            what = f"the reference of scene {self.scene.name!r} is {np.asarray(reference.value).tolist()}"
            raise UnsupportedError(f"{what}: nothing converges to it", f"scenes.{self.scene.name}")
        return reference

    def estimator(self, count: int) -> Estimator:
        """Return the estimator, called once before anybody measures: loading and compiling are not its time."""
        count = count if self.method.axis == "steps" else 0
        with _BUILDING:
            if count not in self._made:
                estimator = self.method.make(self.scene, count)
                estimator.draw(np.random.default_rng(0), 1)
                if self.points == "sobol":
                    SobolSequence(1, np.random.default_rng(0), np.random.default_rng(0))  # loads scipy.stats
                self._made[count] = estimator
            return self._made[count]


def cells_of(study: Study) -> list[Cell]:
    """Return the cells in the order of the study file, Sobol points after random ones."""
    cells: list[Cell] = []
    for number, scene in enumerate(study.scenes):
        for place, method in enumerate(scene.estimators):
            where = f"scenes.{number}.estimators.{place}"
            if method.quantity != scene.quantity:
                what = f"{name_of(method)} estimates the {method.quantity}"
                raise InvalidInputError(f"{where}: {what}, scene {scene.name!r} is about the {scene.quantity}", where)
            kinds: list[Points] = ["random"]
            if study.sobol and method.dimensions is not None:
                kinds.append("sobol")
            for points in kinds:
                cells.append(Cell(len(cells), scene, method, points, study))
        names = [cell.name for cell in cells if cell.scene is scene]
        for name in names:
            if names.count(name) > 1:
                raise InvalidInputError(f"scenes.{number}.estimators: {name!r} is there twice", f"scenes.{number}")
    return cells


def prepare(cells: list[Cell]) -> None:
    """Ask the oracle and call every estimator once: what cannot run says so before anything runs."""
    for cell in cells:
        try:
            _ = cell.reference
            cell.estimator(cell.counts[0])
        except FogproofError as error:
            place = f"scene {cell.scene.name!r}, {cell.name}"
            raise InvalidInputError(f"{place}: {error}", error.path) from None


@lru_cache(maxsize=4)
def cells_of_text(text: str, folder: str) -> list[Cell]:
    """Return the cells of a study given as text, made once a process."""
    return cells_of(study_of(text, folder))


def batches_of(cells: list[Cell]) -> list[Batch]:
    """Return all batches, small counts first: an unfinished study knows something of every cell."""
    batches: list[Batch] = []
    for level in range(max(len(cell.counts) for cell in cells)):
        for cell in cells:
            if level < len(cell.counts):
                count = cell.counts[level]
                for piece in _pieces(cell, count):
                    batches.append(Batch(len(batches), cell.index, level, count, *piece))
    return batches


def _pieces(cell: Cell, count: int) -> list[tuple[int, int, int, int]]:
    """Return (first replicate, replicates, start, samples) of the batches at one count."""
    if cell.method.axis != "samples":
        return [(0, cell.replicates, 0, 1)]
    size = cell.study.batch
    if cell.points == "sobol":
        size = 1 << (size.bit_length() - 1)  # a power of two: a stretch of Sobol points is balanced only then
    if count <= size:
        together = size // count
        firsts = range(0, cell.replicates, together)
        return [(first, min(together, cell.replicates - first), 0, count) for first in firsts]
    starts = range(0, count, size)
    return [(r, 1, start, min(size, count - start)) for r in range(cell.replicates) for start in starts]
