"""A murky atmosphere."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.scene.phase.phase_function import PhaseFunction


@dataclass(frozen=True)
class Murky(PhaseFunction):
    """Murky atmosphere, (1/2 + 33/2 u^32)/(4 pi) with u = (1 + mu)/2 (after Nishita, Miyawaki & Nakamae 1987)."""
