"""Lorenz-Mie scattering by spheres of many sizes, as clouds and aerosols have them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.complex_numbers import ComplexNumber
from fogproof.scene.phase.mie import Mie
from fogproof.scene.phase.phase_function import PhaseFunction
from fogproof.validate import number

SizeDistribution = Literal["gamma", "log-normal"]

WIDEST = {"gamma": 0.5, "log-normal": 1.0}


@dataclass(frozen=True)
class PolydisperseMie(PhaseFunction):
    """Scattering of unpolarised light by homogeneous spheres of many sizes (Hansen & Travis 1974, section 2.4).

    distribution        "gamma": n(d) ~ d^((1 - 3 b)/b) exp(-d/(a b)); "log-normal": of ln d, with the variance ln(1 + b)
    effective_diameter  a, the mean of d weighted with the area d^2 [m]; twice the effective radius
    effective_variance  b, the variance of d so weighted over a^2; below 1/2 for gamma, up to 1 for log-normal. Clouds have 0.1
    wavelength          in vacuum [m]
    refractive_index    of the spheres, n + ik with n > 0 and k >= 0; [n, k] in files
    medium_index        real refractive index of what surrounds them
    """

    distribution: SizeDistribution
    effective_diameter: float
    effective_variance: float
    wavelength: float
    refractive_index: ComplexNumber
    medium_index: float = 1.0

    def __post_init__(self) -> None:
        known = get_args(SizeDistribution)
        if self.distribution not in known:
            raise InvalidValueError("distribution", "must be " + " or ".join(map(repr, known)), self.distribution)
        rule = "must be finite and > 0 [m]"
        diameter = number("effective_diameter", self.effective_diameter, rule, 0, np.inf, open_ends=True)
        one = Mie(diameter, self.wavelength, self.refractive_index, self.medium_index)
        widest = WIDEST[self.distribution]
        rule = f"must lie in [1e-4, {widest:g}] for a {self.distribution} distribution"
        fix = "spheres of one size are Mie(diameter, ...)"
        variance = number("effective_variance", self.effective_variance, rule, 1e-4, widest, fix=fix)
        object.__setattr__(self, "effective_diameter", diameter)
        object.__setattr__(self, "effective_variance", variance)
        for name in ("wavelength", "refractive_index", "medium_index"):
            object.__setattr__(self, name, getattr(one, name))
