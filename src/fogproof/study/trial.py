"""One's own estimators, first called in processes of their own: what ends its process, or never returns, ends no study."""

from __future__ import annotations

import contextlib
import sys
from functools import partial
from typing import Any

import numpy as np

from fogproof.checks.limits import isolated
from fogproof.errors import FogproofError, SubjectError
from fogproof.study.cells import told_of
from fogproof.study.drawn import numbers_of
from fogproof.study.files import Study, study_of
from fogproof.study.methods.own import Own
from fogproof.study.methods.table import name_of

_FEW, _OFTEN = 32, 5
"""Realisations that are drawn from so many generators: hits and misses of any share agree in all with probability 6e-9 at most."""
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
    with contextlib.redirect_stdout(sys.stderr):  # what is printed is no part of an answer
        _drawn(name_of(method), method.make(scene, 0))


def _drawn(name: str, estimator: Any) -> None:
    """Draw a little, and hold it to the contract: n numbers, others from another generator."""
    numbers_of(name, estimator.draw(np.random.default_rng(0), 1), 1)
    drawn = np.array([numbers_of(name, estimator.draw(np.random.default_rng(k), _FEW), _FEW)[0] for k in range(_OFTEN)])
    same = len(np.unique(drawn, axis=0))
    if np.ptp(drawn[0]) > 0 and (same == 1 or (same < _OFTEN and len(np.unique(drawn)) > _FEW)):
        fix = "take all chance from rng"
        raise SubjectError(
            f"{name}: draw(rng, {_FEW}) returns the same realisations though rng is another; {fix}", "draw"
        )
