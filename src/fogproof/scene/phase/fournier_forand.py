"""Fournier & Forand 1994: particles of sea water, of many sizes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fogproof.scene.phase.phase_function import PhaseFunction
from fogproof.validate import number


@dataclass(frozen=True)
class FournierForand(PhaseFunction):
    """Particles whose number falls with their size by a power law (Fournier & Forand 1994, as in Fournier & Jonasz 1999).

    refractive_index  n > 1 of the particles relative to the water
    junge_slope       mu in (3, 5) of the power law r^-mu

    The density is infinite straight ahead. Clear ocean water has n = 1.05 to 1.15 and mu = 3.3 to 4.
    """

    refractive_index: float
    junge_slope: float

    def __post_init__(self) -> None:
        n = number("refractive_index", self.refractive_index, "must be finite and > 1", 1, np.inf, open_ends=True)
        fix = "at 3 all light goes straight on, beyond 5 the formula is not a density"
        rule = "must lie in the open interval (3, 5)"
        slope = number("junge_slope", self.junge_slope, rule, 3, 5, open_ends=True, fix=fix)
        object.__setattr__(self, "refractive_index", n)
        object.__setattr__(self, "junge_slope", slope)

    @classmethod
    def from_backscatter(cls, refractive_index: float, backscatter: float) -> FournierForand:
        """Return the function that sends the share `backscatter` in (0, 1/2) backwards, more than 90 degrees off.

        Source: Fournier & Jonasz 1999, eq. 8, solved for the slope (Mobley, Sundman & Boss 2002).
        """
        cls(refractive_index, 4.0)
        share = number("backscatter", backscatter, "must lie in the open interval (0, 1/2)", 0, 0.5, open_ends=True)
        delta = 2 / (3 * (refractive_index - 1) ** 2)  # at 90 degrees
        exponent = 2 * share if delta == 1 else math.log1p(2 * share * (delta - 1)) / math.log(delta)
        return cls(refractive_index, 3 + 2 * exponent)
