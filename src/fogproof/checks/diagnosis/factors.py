"""Constant factors of a pdf: those that people forget, where the measured one pins one of them, and what else they may be."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from fogproof.checks.diagnosis.contrast import Fit
from fogproof.checks.verdict import Finding

_PI = math.pi
FACTORS = {
    "2 pi": 2 * _PI,
    "4 pi": 4 * _PI,
    "pi": _PI,
    "pi/2": _PI / 2,
    "pi/4": _PI / 4,
    "2/pi": 2 / _PI,
    "4/pi": 4 / _PI,
    "1/pi": 1 / _PI,
    "1/(2 pi)": 0.5 / _PI,
    "1/(4 pi)": 0.25 / _PI,
    "2": 2.0,
    "1/2": 0.5,
    "4": 4.0,
    "1/4": 0.25,
}
_PINNED = 0.01  # relative error of a factor that may be named
_CHANCE = 5.0  # standard errors that chance makes


def named_factor(value: float, error: float, more: Mapping[str, float] | None = None) -> str:
    """Return the name of the one constant that value +- error can be, "" if there is none or it is not pinned.

    more  further constants, such as an albedo or the measure of the domain
    """
    if not (abs(value) < math.inf and 0 <= error <= _PINNED * abs(value)):
        return ""
    known = {**(more or {}), **FACTORS}
    room = error + 1e-4 * abs(value)
    near = [name for name, factor in known.items() if abs(value - factor) <= room and abs(factor - 1) > 1e-3]
    different = {round(math.log(abs(known[name])), 6) for name in near}
    return near[0] if len(different) == 1 else ""


def scaled(base: Fit) -> str:
    """Return in words the constant factor that is all that is wrong with the pdf, "" if there is none."""
    if not (base.constant > 0 and abs(math.log(base.constant)) > _CHANCE * base.doubt):
        return ""
    factor = 1 / base.constant
    words = f"the samples fit the pdf but for a constant factor {factor:.4g} +- {base.doubt * factor:.1g}"
    name = named_factor(factor, base.doubt * factor)
    return f"{words}, that is {name}" if name else words


def differs_in_one_place(factor: float, samples: int) -> str:
    """Return in words that a factor near 1 may be an error of the pdf in one place, if so many samples would not show that.

    Where m of the samples lie and the pdf is off by (factor - 1)/m, their number is off by (factor - 1) sqrt(samples/m) standard
    errors: for any m, by no less than if that were all of them.
    """
    excess = factor - 1
    if abs(excess) * math.sqrt(samples) >= _CHANCE:
        return ""
    what = f"too {'large' if excess > 0 else 'small'} by {abs(excess):.3g} of all probability"
    return f"; or it is right but in one place, and {what} there: {samples} samples do not tell which"


def scaled_or_lost(findings: Sequence[Finding]) -> tuple[str, str]:
    """Return the cause and the words where the valid samples fit the pdf, and their share is not its integral."""
    found = {f.check: f for f in findings}
    part, integral = found.get("continuous part"), found.get("normalisation")
    if not (part and part.statistic and part.effect and integral and integral.effect and integral.resolution):
        return "lost samples", ""
    share, total = part.statistic, part.statistic - part.effect
    if abs(integral.effect) <= integral.resolution.value:
        return "lost samples", ""
    factor = f"a constant factor {total / share:.4g}, or {total:.4g} if it is that of the valid samples alone"
    if part.effect > 0:
        words = f"the samples fit the pdf but for {factor}: {share:.4g} of them are valid, more than it integrates to"
        return "normalisation", words
    return "lost samples", f"{-part.effect:.4g} of the samples are lost, and the others fit; or the pdf has {factor}"
