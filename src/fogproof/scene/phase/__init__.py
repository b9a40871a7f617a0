"""Phase functions: a module a kind, and the table of them."""

from __future__ import annotations

from typing import Annotated, Any

from fogproof.errors import InvalidValueError
from fogproof.scene.kinds import ByKind
from fogproof.scene.phase.approximate_mie import ApproximateMie
from fogproof.scene.phase.cornette_shanks import CornetteShanks
from fogproof.scene.phase.double_henyey_greenstein import DoubleHenyeyGreenstein
from fogproof.scene.phase.draine import Draine
from fogproof.scene.phase.fournier_forand import FournierForand
from fogproof.scene.phase.hazy import Hazy
from fogproof.scene.phase.henyey_greenstein import HenyeyGreenstein
from fogproof.scene.phase.isotropic import Isotropic
from fogproof.scene.phase.legendre_series import LegendreSeries
from fogproof.scene.phase.microflakes import Microflakes
from fogproof.scene.phase.mie import Mie
from fogproof.scene.phase.mixture import Mixture
from fogproof.scene.phase.murky import Murky
from fogproof.scene.phase.of_media import PhaseOfMedia
from fogproof.scene.phase.phase_function import PhaseFunction
from fogproof.scene.phase.phase_function import PhaseFunctionField as PhaseFunctionField
from fogproof.scene.phase.phase_function import require_phase as require_phase
from fogproof.scene.phase.polydisperse_mie import PolydisperseMie
from fogproof.scene.phase.rayleigh import Rayleigh
from fogproof.scene.phase.schlick import Schlick
from fogproof.scene.phase.tabulated import Tabulated
from fogproof.scene.phase.varying import Ramp, VaryingPhase
from fogproof.scene.phase.von_mises_fisher import VonMisesFisher

KINDS: dict[str, type[PhaseFunction]] = {
    "isotropic": Isotropic,
    "henyey-greenstein": HenyeyGreenstein,
    "double-henyey-greenstein": DoubleHenyeyGreenstein,
    "schlick": Schlick,
    "hazy": Hazy,
    "murky": Murky,
    "rayleigh": Rayleigh,
    "cornette-shanks": CornetteShanks,
    "draine": Draine,
    "fournier-forand": FournierForand,
    "von-mises-fisher": VonMisesFisher,
    "mie": Mie,
    "polydisperse-mie": PolydisperseMie,
    "approximate-mie": ApproximateMie,
    "legendre-series": LegendreSeries,
    "tabulated": Tabulated,
    "mixture": Mixture,
}
"""The `kind` of each phase function in files and requests."""

AnyPhase = PhaseFunction | VaryingPhase | PhaseOfMedia
AnyPhaseField = Annotated[AnyPhase, ByKind({**KINDS, "varying": VaryingPhase})]
"""What a heterogeneous medium may have as its phase function."""


def require_any_phase(name: str, value: Any) -> None:
    """Refuse what is no phase function, the same everywhere or varying in space."""
    if not isinstance(value, AnyPhase):
        raise InvalidValueError(name, "must be a phase function", value, "for example HenyeyGreenstein(g=0.5)")


def constant_phase(phase: AnyPhase) -> PhaseFunction | None:
    """Return a phase function that is the same everywhere, None if it varies in space."""
    return phase if isinstance(phase, PhaseFunction) else None


__all__ = [
    "ApproximateMie",
    "CornetteShanks",
    "DoubleHenyeyGreenstein",
    "Draine",
    "FournierForand",
    "Hazy",
    "HenyeyGreenstein",
    "Isotropic",
    "LegendreSeries",
    "Microflakes",
    "Mie",
    "Mixture",
    "Murky",
    "PhaseFunction",
    "PhaseOfMedia",
    "PolydisperseMie",
    "Ramp",
    "Rayleigh",
    "Schlick",
    "Tabulated",
    "VaryingPhase",
    "VonMisesFisher",
]
