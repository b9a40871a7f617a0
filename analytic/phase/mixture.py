"""A weighted mean of phase functions."""

from __future__ import annotations

from fractions import Fraction

from fogproof.scene.phase import Mixture, PhaseFunction


def parts(phase: Mixture) -> list[tuple[Fraction, PhaseFunction]]:
    """Return the components with their weights, exact and divided by their sum."""
    total = sum(map(Fraction, phase.weights))
    return [(Fraction(weight) / total, part) for weight, part in zip(phase.weights, phase.components, strict=True)]
