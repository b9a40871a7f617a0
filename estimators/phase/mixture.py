"""A weighted mean of phase functions; `weighted` draws from it."""

from __future__ import annotations

from fogproof.estimators.phase.functions import phase_table
from fogproof.scene.phase import Mixture, PhaseFunction


def parts(phase: Mixture) -> list[tuple[float, PhaseFunction]]:
    """Return the components and their weights."""
    total = sum(phase.weights)
    return [(weight / total, part) for weight, part in zip(phase.weights, phase.components, strict=True)]


def table(phase: Mixture) -> Mixture:
    """Return the mixture of what the components are drawn from."""
    return Mixture(tuple(phase_table(part) for part in phase.components), phase.weights)
