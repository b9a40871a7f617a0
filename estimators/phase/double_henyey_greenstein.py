"""Two Henyey-Greenstein lobes, a weighted mean; `weighted` draws from it."""

from __future__ import annotations

from fogproof.scene.phase import DoubleHenyeyGreenstein, HenyeyGreenstein, PhaseFunction


def parts(phase: DoubleHenyeyGreenstein) -> list[tuple[float, PhaseFunction]]:
    """Return the lobes and their weights."""
    return [(phase.weight, HenyeyGreenstein(phase.g1)), (1 - phase.weight, HenyeyGreenstein(phase.g2))]
