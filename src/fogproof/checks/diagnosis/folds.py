"""Signs that are lost: what lies at negative coordinates is found at their absolute values."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import product

import numpy as np

from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting

_ROUNDED = 1e-6  # below 0, of the greatest coordinate, is no sign
_MISSING = 20.0  # samples that the claim has at negative coordinates
_MOST = 6  # signs
_LIKELIER = 2.0  # logarithm of how much likelier half a turn is never drawn
_EVEN = 1e-9  # relative difference of densities that are one


def hypotheses(setting: Setting, names: Sequence[str], azimuth: tuple[int, ...] = ()) -> Iterator[Hypothesis]:
    """Yield that all coordinates have lost their signs of which no sample is negative, and of which many should be.

    names    of the coordinates
    azimuth  coordinates between which one runs: where the claim is even, half a turn that is never drawn is the same, and likelier
    """
    n = len(setting.contrast.x)
    x, z = (points.reshape(len(points), -1) for points in (setting.contrast.x, setting.contrast.z))
    weight = setting.values[n:] / setting.contrast.q[n:]
    expected = n * (weight @ (z < 0)) / max(float(weight.sum()), 1e-300)
    lost = np.flatnonzero((x.min(axis=0) >= -_ROUNDED * np.abs(x).max(axis=0)) & (expected > _MISSING))
    if not 0 < len(lost) <= _MOST:
        return
    signs = np.ones((2 ** len(lost), x.shape[1]))
    signs[:, lost] = list(product((1.0, -1.0), repeat=len(lost)))
    *first, last = (names[axis] for axis in lost.tolist())
    told = f"signs of {', '.join(first)} and {last} are" if first else f"sign of {last} is"
    words = f"these samples fit the pdf folded: the {told} lost"
    points = setting.contrast.points
    likelier = set(lost.tolist()) <= set(azimuth) and all(
        np.allclose(setting.values, setting.p(_with(points, sign)), rtol=_EVEN, atol=0.0) for sign in signs[1:]
    )
    yield Hypothesis("lost sign", words, partial(_folded, signs, lost), prior=-_LIKELIER if likelier else 0.0)


def _with(x: np.ndarray, sign: np.ndarray) -> np.ndarray:
    return np.asarray((x.reshape(len(x), -1) * sign).reshape(x.shape))


def _folded(signs: np.ndarray, lost: np.ndarray, setting: Setting, _: float) -> Density:
    """Return the sum of the claim at all points whose coordinates have these absolute values, 0 where one of them is negative."""

    def density(x: np.ndarray) -> np.ndarray:
        kept = np.all(x.reshape(len(x), -1)[:, lost] >= 0, axis=1)
        total = setting.p(x) + sum(setting.p(_with(x, sign)) for sign in signs[1:])
        return np.where(kept, total, 0.0)

    return density
