"""Which phase function a medium has: parameters only. The oracle and the estimators each bring their own formulas.

Convention: mu is the *forward* cosine, (propagation direction in) . (propagation direction out); g is the mean of mu
and g > 0 scatters forward.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fogproof.scene.kinds import ByKind
from fogproof.validate import number


@dataclass(frozen=True)
class Isotropic:
    """Equal in all directions: 1/(4 pi) [1/sr]."""


@dataclass(frozen=True)
class HenyeyGreenstein:
    """Henyey & Greenstein 1941, with mean cosine `g` in the open interval (-1, 1)."""

    g: float

    def __post_init__(self) -> None:
        fix = "at the ends the phase function is a delta, which has no density"
        object.__setattr__(
            self, "g", number("g", self.g, "must lie in the open interval (-1, 1)", -1, 1, open_ends=True, fix=fix)
        )


@dataclass(frozen=True)
class Rayleigh:
    """Scattering by particles much smaller than the wavelength, unpolarised light (Rayleigh 1871)."""


PhaseFunction = Isotropic | HenyeyGreenstein | Rayleigh
PHASE_FUNCTIONS: dict[str, type[PhaseFunction]] = {
    "isotropic": Isotropic,
    "henyey-greenstein": HenyeyGreenstein,
    "rayleigh": Rayleigh,
}
"""The `kind` of each phase function in files and requests."""

PhaseFunctionField = Annotated[PhaseFunction, ByKind(PHASE_FUNCTIONS)]
