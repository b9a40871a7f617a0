"""Rayleigh scattering."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.scene.phase.phase_function import PhaseFunction


@dataclass(frozen=True)
class Rayleigh(PhaseFunction):
    """Scattering by particles much smaller than the wavelength, unpolarised light (Rayleigh 1871)."""
