"""Cornette & Shanks 1992."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fogproof.scene.phase.phase_function import PhaseFunction, asymmetry


@dataclass(frozen=True)
class CornetteShanks(PhaseFunction):
    """Cornette & Shanks 1992: Henyey-Greenstein times 1 + mu^2; `g` in (-1, 1) is not the mean cosine.

    It is Draine's function with alpha = 1.
    """

    g: float
    alpha: ClassVar[float] = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "g", asymmetry("g", self.g))
