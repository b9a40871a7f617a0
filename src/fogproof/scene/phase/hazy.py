"""A hazy atmosphere."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.scene.phase.phase_function import PhaseFunction


@dataclass(frozen=True)
class Hazy(PhaseFunction):
    """Hazy atmosphere, (1/2 + 9/2 u^8)/(4 pi) with u = (1 + mu)/2 (after Nishita, Miyawaki & Nakamae 1987)."""
