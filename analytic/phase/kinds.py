"""From a phase function to its formulas: those of its own module, or of the fallback that works from the pdf."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from fogproof.errors import InvalidValueError, UnsupportedError, shorten
from fogproof.scene.kinds import given
from fogproof.scene.phase import KINDS, PhaseFunction

ROOM = "fogproof.analytic.phase"

Parts = list[tuple[Fraction, PhaseFunction]]


def formula(phase: PhaseFunction, name: str) -> Callable[..., Any]:
    """Return a function of `ROOM` for a phase function that is no weighted mean."""
    known: Callable[..., Any] | None = given(phase, ROOM, name)
    if known is None:
        from fogproof.analytic.phase import fallback

        known = getattr(fallback, name)
    return known


def weighted_parts(phase: PhaseFunction) -> Parts:
    """Return a phase function as (weight, phase function) pairs; the weights are exact, positive, and sum to 1."""
    if not isinstance(phase, PhaseFunction):
        known = ", ".join(kind.__name__ for kind in KINDS.values())
        raise InvalidValueError("phase", "must be a phase function", phase, f"one of {known}")
    parts = given(phase, ROOM, "parts")
    if parts is not None:
        return [(w * v, one) for w, part in parts(phase) if w for v, one in weighted_parts(part)]
    if given(phase, ROOM, "pdf") is None:
        raise UnsupportedError(f"the oracle has no formula for the phase function {shorten(phase)}", "phase")
    return [(Fraction(1), phase)]
