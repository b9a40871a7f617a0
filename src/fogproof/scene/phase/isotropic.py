"""Isotropic scattering."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.scene.phase.phase_function import PhaseFunction


@dataclass(frozen=True)
class Isotropic(PhaseFunction):
    """Equal in all directions: 1/(4 pi) [1/sr]."""
