"""Two Henyey-Greenstein lobes: a weighted mean."""

from __future__ import annotations

from fractions import Fraction

from fogproof.scene.phase import DoubleHenyeyGreenstein, HenyeyGreenstein, PhaseFunction


def parts(phase: DoubleHenyeyGreenstein) -> list[tuple[Fraction, PhaseFunction]]:
    """Return the lobes with their weights, exact."""
    weight = Fraction(phase.weight)
    return [(weight, HenyeyGreenstein(phase.g1)), (1 - weight, HenyeyGreenstein(phase.g2))]
