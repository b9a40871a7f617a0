"""Lorenz-Mie scattering by a sphere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.complex_numbers import ComplexNumber, as_complex
from fogproof.scene.phase.phase_function import PhaseFunction
from fogproof.validate import number


@dataclass(frozen=True)
class Mie(PhaseFunction):
    """Scattering of unpolarised light by a homogeneous sphere (Lorenz 1890, Mie 1908).

    diameter          of the sphere [m]
    wavelength        in vacuum [m]
    refractive_index  of the sphere, n + ik with n > 0 and k >= 0 (a positive imaginary part absorbs); [n, k] in files
    medium_index      real refractive index of what surrounds it
    """

    diameter: float
    wavelength: float
    refractive_index: ComplexNumber
    medium_index: float = 1.0

    def __post_init__(self) -> None:
        for name in ("diameter", "wavelength"):
            value = number(name, getattr(self, name), "must be finite and > 0 [m]", 0, np.inf, open_ends=True)
            object.__setattr__(self, name, value)
        medium = number("medium_index", self.medium_index, "must be finite and > 0", 0, np.inf, open_ends=True)
        object.__setattr__(self, "medium_index", medium)
        index = as_complex("refractive_index", self.refractive_index)
        if not (index.real > 0 and index.imag >= 0):
            fix = "absorption is a positive imaginary part here; take the conjugate of n - ik"
            raise InvalidValueError("refractive_index", "must be n + ik with n > 0 and k >= 0", index, fix)
        if index == medium:
            raise InvalidValueError(
                "refractive_index",
                "must differ from medium_index",
                index,
                "a sphere of the same index scatters nothing",
            )
        object.__setattr__(self, "refractive_index", index)
