"""Does each part of a product fit the claim, and do the parts only together not?"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.checks.diagnosis.explaining import contrasted
from fogproof.checks.subject import Subject
from fogproof.contracts import Draw
from fogproof.domains import Product

_MISFIT = 4.0  # standard deviations of a chi-square that is no chance


def dependent(subject: Subject, product: Product, samples: int, seed: int) -> str:
    """Return in words that parts which fit the claim depend on each other where the claim says that they do not; "" if not so.

    The later columns of samples in another order are independent of the first ones: such points fit a claim of which that is true.
    """
    first = 0
    for part in product.parts[:-1]:
        first += math.prod(part.shape)
        shown = contrasted(_shuffled(subject, first), samples, seed)
        if shown is not None and shown[1].left < _MISFIT * math.sqrt(2 * shown[1].freedom):
            words = (
                f"the columns up to {first - 1} and those from {first} on fit the pdf by themselves, and not together"
            )
            return f"{words}: they depend on each other, as where they share a uniform"
    return ""


def _shuffled(subject: Subject, first: int) -> Subject:
    """Return the subject with the columns from `first` on in another order than the others."""

    def sample(*arguments: Any) -> Draw:
        result = subject.sample(*arguments)
        draw = result if isinstance(result, Draw) else Draw(result)
        x = np.array(draw.x, dtype=float)
        good = np.ones(len(x), dtype=bool) if draw.valid is None else np.asarray(draw.valid, dtype=bool)
        at = np.flatnonzero(good)
        x[at, first:] = x[np.random.default_rng(len(x)).permutation(at), first:]
        return Draw(x, valid=good)

    return replace(subject, sample=sample)
