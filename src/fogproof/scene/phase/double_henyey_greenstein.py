"""Two Henyey-Greenstein lobes."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.scene.phase.phase_function import PhaseFunction, asymmetry
from fogproof.validate import number


@dataclass(frozen=True)
class DoubleHenyeyGreenstein(PhaseFunction):
    """Two Henyey-Greenstein lobes: `weight` in [0, 1] of the one with mean cosine `g1`, the rest with `g2`."""

    g1: float
    g2: float
    weight: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "g1", asymmetry("g1", self.g1))
        object.__setattr__(self, "g2", asymmetry("g2", self.g2))
        object.__setattr__(self, "weight", number("weight", self.weight, "must lie in [0, 1]", 0, 1))
