"""Jendersie & d'Eon 2023: water droplets of fog and clouds, fitted by two lobes."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.scene.phase.phase_function import PhaseFunction
from fogproof.validate import number

SMALLEST, LARGEST = 5e-324, 50e-6


@dataclass(frozen=True)
class ApproximateMie(PhaseFunction):
    """Water droplets of one diameter, fitted by a Henyey-Greenstein and a Draine lobe (Jendersie & d'Eon 2023).

    diameter  of the droplets [m], in (0, 50e-6]; fog has 5e-6 to 20e-6, clouds up to 50e-6

    The fit is for visible light and shows neither glory nor fogbow; `Mie` is the exact function of one sphere. Renderers take
    this diameter in micrometres.
    """

    diameter: float

    def __post_init__(self) -> None:
        rule, fix = "must lie in (0, 5e-05] [m]", "the fit ends at 50 micrometres, and a micrometre is 1e-6 m"
        value = number("diameter", self.diameter, rule, SMALLEST, LARGEST, fix=fix)
        object.__setattr__(self, "diameter", value)
