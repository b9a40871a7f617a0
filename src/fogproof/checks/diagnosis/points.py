"""Points that come again and again: is what lies beyond them clamped to them, or do they have a probability of their own?"""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.diagnosis.contrast import Contrast
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject
from fogproof.errors import shorten

_DRAWN = 1 << 15  # samples among which they are looked for
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


def single_points(subject: Subject, samples: int, seed: int) -> tuple[str, str]:
    """Return "clamped" or "atom", and in words where the samples come back to and with which probability; "" if nowhere."""
    contrast = Contrast.of(subject, min(_DRAWN, samples), batch_generator(seed, "diagnosis", 2, 0))
    if contrast is None:
        return "", ""
    if told := clamped(contrast, subject):
        return "clamped", told
    points, counts = np.unique(contrast.x, axis=0, return_counts=True)
    if counts.max() < _OFTEN:
        return "", ""
    often, share = points[np.argmax(counts)], counts.max() / len(contrast.x)
    words = f"{share:.3g} of the samples are {shorten(often.tolist())}, to which a pdf gives no probability"
    return "atom", f"{words}: if that is meant, declare atoms={{point: probability}}"
