"""Points that come again and again: is what lies beyond them clamped to them, or do they have a probability of their own?"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from fogproof.checks.diagnosis.contrast import Contrast
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject
from fogproof.errors import shorten

_DRAWN = 1 << 15  # samples among which they are looked for
_MOST = 64  # points that are looked at
_DIGITS = 12  # of a coordinate that are no rounding
_OFTEN = 10  # times that a point must come
_CHANCE = 5.0  # standard errors that chance makes


def clamped(contrast: Contrast, subject: Subject) -> str:
    """Return in words which coordinate is clamped at what, "" if none is.

    Its outermost value comes as often as the pdf has probability beyond it, which the points of a known law tell without a
    quadrature, and no value between comes nearly as often: numbers of few bits are none that were clamped.
    """
    x, n = contrast.x, len(contrast.x)
    weight = subject.density(contrast.z) / contrast.q[n:]
    columns, others = x.reshape(n, -1).T, contrast.z.reshape(len(contrast.z), -1).T
    for k, (column, other) in enumerate(zip(columns, others, strict=True)):
        values, counts = np.unique(column, return_counts=True)
        between = int(counts[1:-1].max(initial=0))
        for end, beyond in ((-1, other > values[-1]), (0, other < values[0])):
            share = counts[end] / n
            lost, spread = float(np.mean(weight * beyond)), float(np.std(weight * beyond)) / math.sqrt(len(other))
            chance = _CHANCE * math.hypot(spread, math.sqrt(share * (1 - share) / n))
            plain = counts[end] >= _OFTEN * max(between, 1)
            if plain and lost > _CHANCE * spread and abs(lost - share) < chance:
                name = f"x[{k}]" if x.ndim > 1 else "x"
                told = (
                    f"{share:.3g} of the samples have {name} = {values[end]:.6g}, and the pdf has {lost:.3g} beyond it"
                )
                return f"{told}: what lies there is clamped to it"
    return ""


def single_points(subject: Subject, samples: int, seed: int) -> tuple[str, str, Subject]:
    """Return "clamped" or "atom", and in words where the samples come back to and with which probability; "" if nowhere.

    The third is the subject with these points declared, so that what lies between them is the rest.
    """
    contrast = Contrast.of(subject, min(_DRAWN, samples), batch_generator(seed, "diagnosis", 2, 0))
    if contrast is None:
        return "", "", subject
    points, counts = np.unique(contrast.x, axis=0, return_counts=True)
    order = np.argsort(-counts, kind="stable")[:_MOST]
    again = order[counts[order] >= _OFTEN]
    found = {_key(points[i]): float(counts[i] / len(contrast.x)) for i in again.tolist()}
    rest = replace(subject, atoms={**subject.atoms, **found})
    if told := clamped(contrast, subject):
        return "clamped", told, rest
    if not found:
        return "", "", subject
    point, share = next(iter(found.items()))
    named = shorten(list(point) if isinstance(point, tuple) else point)
    words = f"{share:.3g} of the samples are {named}, to which a pdf gives no probability"
    return "atom", f"{words}: if that is meant, declare atoms={{point: probability}}", rest


def _key(point: np.ndarray) -> tuple[float, ...] | float:
    return tuple(point.tolist()) if point.ndim else float(point)


def few_values(contrast: Contrast) -> str:
    """Return in words which coordinate takes few values alone, "" if none does."""
    if contrast.law.stepped:
        return ""
    u = contrast.law.coordinates(contrast.x, np.full((len(contrast.x), len(contrast.law.axes)), 0.5))
    for name, column in zip(contrast.law.axes, u.T, strict=True):
        values = len(np.unique(np.round(column, _DIGITS)))
        if 1 < values <= len(column) // _OFTEN:
            return f"{name} takes {values} values alone"
    return ""
