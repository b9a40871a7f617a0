"""The cells of a study: each an estimator in a scene with one kind of points."""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Literal

import numpy as np

from fogproof.contracts import Estimator, Reference
from fogproof.errors import FogproofError, InvalidInputError, UnsupportedError
from fogproof.study.drawn import numbers_of
from fogproof.study.files import Study, StudyScene, study_of
from fogproof.study.methods.method import Method
from fogproof.study.methods.own import Own
from fogproof.study.methods.table import name_of
from fogproof.study.sobol import SobolSequence

Points = Literal["random", "sobol"]
_BUILDING = threading.RLock()
"""Large modules are loaded by the first estimator that needs them, which two threads at a time may not do."""
EXACT_CALLS = 1024
"""Realisations of an exact estimator: it needs one, but its time is measured."""
MARCHES = 8
"""Realisations of each march: they are alike, but their time is measured."""
_MARCH_FACTOR = 2.5
"""Marches are made at more counts than the study's: neighbours differ by this factor at most, so that their order can be seen."""
SOBOL_CALL = 1 << 14
"""Sobol points an estimator is given at once: it works in blocks, and must see all of a block's points together."""


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
        if self.method.axis == "steps":
            return _denser(self.study.samples)
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

    @cached_property
    def dimensions(self) -> int | None:
        """Uniforms a realisation, asked once: one's own estimator has its sources read for it."""
        dimensions: int | None = self.method.dimensions
        return dimensions

    def estimator(self, count: int) -> Estimator:
        """Return the estimator, called once before anybody measures: loading and compiling are not its time."""
        count = count if self.method.axis == "steps" else 0
        with _BUILDING:
            if count not in self._made:
                estimator = self.method.make(self.scene, count)
                numbers_of(self.name, estimator.draw(np.random.default_rng(0), 1), 1)
                if self.points == "sobol":
                    _ = self.dimensions
                    SobolSequence(1, np.random.default_rng(0), np.random.default_rng(0))  # loads scipy.stats
                self._made[count] = estimator
            return self._made[count]


def _denser(counts: tuple[int, ...]) -> tuple[int, ...]:
    """Return the counts with more of them between, so that neighbours differ by `_MARCH_FACTOR` at most."""
    found = [counts[0]]
    for before, after in pairwise(counts):
        pieces = math.ceil(math.log(after / before) / math.log(_MARCH_FACTOR))
        found += [round(before * (after / before) ** (k / pieces)) for k in range(1, pieces)] + [after]
    return tuple(sorted(set(found)))


def cells_of(study: Study) -> list[Cell]:
    """Return the cells in the order of the study file, Sobol points after random ones."""
    cells: list[Cell] = []
    for number, scene in enumerate(study.scenes):
        for place, method in enumerate(scene.estimators):
            where = f"scenes.{number}.estimators.{place}"
            if method.quantity not in (scene.quantity, None):
                what = f"{name_of(method)} estimates the {method.quantity}"
                told = f"{study.origin}: {where}: {what}, scene {scene.name!r} is about the {scene.quantity}"
                raise InvalidInputError(told, where)
            kinds: list[Points] = ["random"]
            try:
                if study.sobol and method.dimensions is not None:
                    kinds.append("sobol")
            except FogproofError as error:
                raise InvalidInputError(f"{study.origin}: {where}: {error}", error.path) from None
            for points in kinds:
                cells.append(Cell(len(cells), scene, method, points, study))
        names = [cell.name for cell in cells if cell.scene is scene]
        for name in names:
            if names.count(name) > 1:
                told = f"{study.origin}: scenes.{number}.estimators: {name!r} is there twice"
                raise InvalidInputError(told, f"scenes.{number}")
    return cells


def prepare(cells: list[Cell], tried: bool = False) -> None:
    """Ask the oracle, also of what it knows of each estimator, and call each once: what cannot run says so before anything runs.

    tried  whether one's own have been called elsewhere (`trial`), and are not called here
    """
    for cell in cells:
        try:
            _ = cell.reference
            if not (tried and isinstance(cell.method, Own)):
                cell.estimator(cell.counts[0])
                _ = cell.method.variance(cell.scene), cell.method.bounds(cell.scene)
        except FogproofError as error:
            raise told_of(cell.study, cell.scene, cell.name, error) from None


def told_of(study: Study, scene: StudyScene, name: str, error: FogproofError) -> InvalidInputError:
    """Return what is wrong with an estimator of a scene; an error that bears its name says it once."""
    what = str(error).removeprefix(f"{name}: ")
    return InvalidInputError(f"{study.origin}: scene {scene.name!r}, {name}: {what}", error.path)


@lru_cache(maxsize=4)
def cells_of_text(text: str, folder: str) -> list[Cell]:
    """Return the cells of a study given as text, made once a process."""
    return cells_of(study_of(text, folder))
