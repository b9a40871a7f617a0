"""What goes wrong with rotations as unit quaternions: a square root, half angles, an even angle of rotation, a cube for a ball."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import combinations

import numpy as np

from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting, of_points


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened to quaternions, the simplest first; all are even, as q and -q are one rotation."""
    yield Hypothesis("uniform law", "these samples are uniform", lambda s, _: lambda q: np.ones(len(q)))
    for scalar in (3, 0):
        conjugate = np.where(np.arange(4) == scalar, 1.0, -1.0)
        words = f"these samples fit the pdf of the inverse rotation, with the real part in column {scalar}"
        yield Hypothesis("sign convention", words, of_points(partial(np.multiply, conjugate)))
        words = "these samples fit the pdf with the angle of rotation drawn evenly: 1 - its cosine is missing"
        words += f", with the real part in column {scalar}"
        yield Hypothesis("missing Jacobian", words, _over(partial(_versine, scalar)))
    for order, words in (([3, 0, 1, 2], "first for last"), ([1, 2, 3, 0], "last for first")):
        words = f"these samples fit the pdf with the real part {words}"
        yield Hypothesis("swapped axes", words, of_points(partial(np.take, indices=order, axis=1)))
    words = "these samples fit the pdf with the columns 0 and 3 swapped: the real part has changed places with another"
    yield Hypothesis("swapped axes", words, of_points(partial(np.take, indices=[3, 1, 2, 0], axis=1)))
    words = "these samples are points of a cube, normalised without rejection"
    yield Hypothesis("normalised cube", words, _over(lambda q: np.abs(q).max(axis=1) ** 4))
    for i, j in combinations(range(4), 2):
        words = f"a square root is missing: the length of the columns {i} and {j} is even where its square is meant"
        yield Hypothesis("missing square root", words, _over(partial(_length, [i, j])))
    for i, j in combinations(range(4), 2):
        for sign, name in ((1, "the same sign"), (-1, "opposite signs")):
            words = f"the columns {i} and {j} have {name} always: as of angles over pi where 2 pi is meant"
            yield Hypothesis("skipped region", words, partial(_signed, i, j, sign))


def _over(divisor: Callable[[np.ndarray], np.ndarray]) -> Callable[[Setting, float], Density]:
    return lambda setting, _: lambda q: setting.p(q) / np.maximum(divisor(q), 1e-12)


def _versine(scalar: int, q: np.ndarray) -> np.ndarray:
    """Return half of 1 - cos of the angle of rotation."""
    return np.asarray(np.sum(np.delete(q, scalar, axis=1) ** 2, axis=1))


def _length(columns: list[int], q: np.ndarray) -> np.ndarray:
    return np.asarray(np.sqrt(np.sum(q[:, columns] ** 2, axis=1)))


def _signed(i: int, j: int, sign: int, setting: Setting, _: float) -> Density:
    return lambda q: setting.p(q) * (sign * q[:, i] * q[:, j] >= 0)
