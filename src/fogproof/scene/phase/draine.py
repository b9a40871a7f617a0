"""Draine 2003."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.scene.phase.phase_function import PhaseFunction, asymmetry
from fogproof.validate import number


@dataclass(frozen=True)
class Draine(PhaseFunction):
    """Draine 2003: Henyey-Greenstein times 1 + alpha mu^2, `g` in (-1, 1), `alpha` >= 0.

    alpha = 0 is Henyey-Greenstein, alpha = 1 Cornette-Shanks, g = 0 with alpha = 1 Rayleigh.
    """

    g: float
    alpha: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "g", asymmetry("g", self.g))
        object.__setattr__(self, "alpha", number("alpha", self.alpha, "must be finite and >= 0", 0))
