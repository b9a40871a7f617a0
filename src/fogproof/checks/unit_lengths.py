"""Directions have length 1: how far rounding takes one from it in usual samples, and how much further in a few.

Measured in single precision, in roundings of 2^-24: normalised vectors are off by 3, whole BSDFs of Mitsuba 3 by 13, products of
ten rotations by 9. Cosines by a textbook formula pass 1 by 284 (Henyey-Greenstein, g = 1e-3) to 1100 (von Mises-Fisher with
kappa = 1e-3), but only at the pole of the lobe, in one of ten thousand samples: there the sine is 0, and the direction right.
"""

from __future__ import annotations

import numpy as np

from fogproof.checks.subject import Subject
from fogproof.domains.law import squared, vector_columns

NAME = "unit length"
_USUAL = 64  # roundings: 7e-15 in double precision, 4e-6 in single
_POLES = 1e-3  # share of the samples that may be off by more, as far as the domain allows
_FEW = 4  # samples that may, however few there are


def off_length(subject: Subject, x: np.ndarray) -> np.ndarray:
    """Return (n,) which points hold a vector whose length is off by more than rounding explains in usual samples.

    What is no number, or infinite, has no length.
    """
    columns = vector_columns(subject.domain)
    with np.errstate(over="ignore", invalid="ignore"):
        errors = [np.abs(squared(x[:, first:last]) - 1) > 2 * _USUAL * subject.roundoff for first, last in columns]
    return np.any(errors, axis=0) & np.isfinite(x).all(axis=1) if errors else np.zeros(len(x), dtype=bool)


def too_many(count: int, n: int) -> bool:
    """Return whether so many of n samples are more than those at the poles of a lobe."""
    return count > max(_FEW, _POLES * n)


def told(subject: Subject, x: np.ndarray) -> str:
    """Return in words how far the length of a point's vectors is off."""
    worst = max((np.linalg.norm(x[first:last]) - 1 for first, last in vector_columns(subject.domain)), key=abs)
    allowed = _USUAL * subject.roundoff
    return f"a direction is {abs(worst):.2g} too {'long' if worst > 0 else 'short'}, rounding explains {allowed:.1g}: normalise it"
