"""From a phase function to the formulas in its own module."""

from __future__ import annotations

from typing import Any

from fogproof.errors import UnsupportedError, shorten
from fogproof.scene.kinds import given
from fogproof.scene.phase import PhaseFunction

ROOM = "fogproof.estimators.phase"

Parts = list[tuple[float, PhaseFunction]]
"""Weights that sum to 1, and phase functions that are no weighted means."""


def formula(phase: PhaseFunction, name: str) -> Any:
    """Return a function that every kind has."""
    known = given(phase, ROOM, name)
    if known is None:
        raise UnsupportedError(f"nothing draws from the phase function {shorten(phase)}", "phase")
    return known


def weighted_parts(phase: PhaseFunction, share: float = 1.0) -> Parts:
    """Return the components of a weighted mean, nested ones unpacked, or the phase function itself."""
    parts = given(phase, ROOM, "parts")
    if parts is None:
        return [(share, phase)]
    return [one for weight, part in parts(phase) if weight > 0 for one in weighted_parts(part, share * weight)]
