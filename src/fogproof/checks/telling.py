"""What a broken promise looks like, in words: few digits, a miss by little, a telling ratio or function."""

from __future__ import annotations

import numpy as np

from fogproof.checks.digits import digits_of
from fogproof.checks.subject import Subject
from fogproof.domains import Discrete
from fogproof.domains.law import at_the_ends

_NEARLY = 1e-6  # slack: 3e-5 of a size, where an end lies; more is no rounding of single precision either
_ENOUGH = 16  # densities that tell how they are wrong
_VARIES = 1e-3  # relative: what is plainly no rounding
# Of a step: domains forgive the length of a vector 512 times its slack, and a rounded one is off by 4 steps.
_ROUNDED = 1 / 128


def few_digits(subject: Subject, x: np.ndarray) -> str:
    """Return in words that points lie outside of the domain only because few digits of them are printed; "" if not so."""
    digits = digits_of(x) if x.ndim > 1 and len(x) else None
    if digits is None:
        return ""
    slack = _ROUNDED * (digits.relative + digits.absolute)
    return f"; {digits.words}" if bool(np.all(subject.domain.contains(x, slack))) else ""


def nearly(subject: Subject, x: np.ndarray, outside: np.ndarray) -> str:
    """Return in words that those of the points that lie outside do by little, and by how much they may; "" if not so."""
    if isinstance(subject.domain, Discrete) or not outside.any():
        return ""
    if not bool(np.all(subject.domain.contains(x, _NEARLY)[outside])):  # of a half line, all points tell the size
        return ""
    forgiven = at_the_ends(16 * subject.roundoff)  # as in `in_domain`
    return f", beyond an end by more than rounding explains, {forgiven:.0e} of the domain's size: clamp it"


def relation(got: np.ndarray, right: np.ndarray) -> str:
    """Return in words what all returned densities have to do with those that are claimed, if it is plain."""
    if len(got) < _ENOUGH:
        return ""
    with np.errstate(all="ignore"):
        others = {}
        if np.ptp(right) > _VARIES * np.max(np.abs(right)):  # a constant is the same as many a function of it
            others = {"its logarithm is returned": np.log(right), "one over it is returned": 1 / right}
        ratio = float(np.median(got / right))
        if np.isfinite(ratio) and ratio > 0 and abs(ratio - 1) > _VARIES:
            others[f"{ratio:.6g} times it is returned"] = ratio * right
        found = [
            words for words, value in others.items() if np.all(np.abs(got - value) <= 1e-5 * np.abs(value) + 1e-12)
        ]
    return f"; everywhere {found[0]}" if found else ""


def ratio_of(got: float, right: float) -> str:
    """Return in words a telling ratio of the returned to the claimed density, if it is one."""
    for name, factor in (
        ("2 pi", 2 * np.pi),
        ("4 pi", 4 * np.pi),
        ("1/(2 pi)", 0.5 / np.pi),
        ("1/(4 pi)", 0.25 / np.pi),
    ):
        if right > 0 and abs(got / right / factor - 1) < 1e-6:
            return f" ({name} times pdf)"
    return ""
