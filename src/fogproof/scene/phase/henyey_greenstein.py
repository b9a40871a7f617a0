"""Henyey & Greenstein 1941."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.scene.phase.phase_function import PhaseFunction, asymmetry


@dataclass(frozen=True)
class HenyeyGreenstein(PhaseFunction):
    """Henyey & Greenstein 1941, with mean cosine `g` in the open interval (-1, 1)."""

    g: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "g", asymmetry("g", self.g))
