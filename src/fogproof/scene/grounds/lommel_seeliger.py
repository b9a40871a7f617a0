"""The ground of Lommel and Seeliger: light scattered once by a half space of dark grains, as on the Moon."""

from __future__ import annotations

from dataclasses import dataclass, field

from fogproof.scene.phase import Isotropic, PhaseFunctionField, require_phase
from fogproof.validate import number


@dataclass(frozen=True)
class LommelSeeligerGround:
    """A ground of BRDF albedo f_p(cos of the scattering angle)/(mu0 + mu) [1/sr].

    albedo  of a grain, in [0, 1]; less than half of it is reflected by isotropic grains
    phase   phase function of the grains

    Source: Seeliger 1884; Hapke 2012, Theory of Reflectance and Emittance Spectroscopy, section 8.3.
    """

    albedo: float
    phase: PhaseFunctionField = field(default_factory=Isotropic)

    def __post_init__(self) -> None:
        object.__setattr__(self, "albedo", number("albedo", self.albedo, "must lie in [0, 1]", 0, 1))
        require_phase("phase", self.phase)
