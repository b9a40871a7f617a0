"""One's own estimators, first called in processes of their own: what ends its process, or never returns, ends no study."""

from __future__ import annotations

from functools import partial

import numpy as np

from fogproof.checks.limits import isolated
from fogproof.errors import FogproofError
from fogproof.study.cells import told_of
from fogproof.study.drawn import numbers_of
from fogproof.study.files import Study, study_of
from fogproof.study.methods.own import Own
from fogproof.study.methods.table import name_of

WORKER = "fogproof.study.batches"
"""What takes a worker long to load."""


def has_own(study: Study) -> bool:
    """Whether somebody else's code is among the estimators."""
    return any(isinstance(method, Own) for scene in study.scenes for method in scene.estimators)


def try_own(study: Study) -> None:
    """Load, make and call each of one's own estimators once, or say which cannot, as an `InvalidInputError`."""
    for number, scene in enumerate(study.scenes):
        for place, method in enumerate(scene.estimators):
            if isinstance(method, Own):
                try:
                    isolated(partial(_call, study.text, study.folder, number, place), preload=[WORKER])
                except FogproofError as error:
                    raise told_of(study, scene, name_of(method), error) from None


def _call(text: str, folder: str, number: int, place: int) -> None:
    scene = study_of(text, folder).scenes[number]
    method = scene.estimators[place]
    _ = method.dimensions
    numbers_of(name_of(method), method.make(scene, 0).draw(np.random.default_rng(0), 1), 1)
