"""A medium whose extinction depends on the direction alone."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.media.common import channels_with, read_only, set_common
from fogproof.scene.phase import AnyPhaseField, Isotropic
from fogproof.validate import Channels, as_float_array, nonnegative_channels, require


@dataclass(frozen=True, eq=False)
class AnisotropicMedium:
    """Extinction that depends on the direction w alone: sigma_t(w) = sigma sqrt(w . S w), a medium of aligned flakes.

    sigma     extinction coefficient of the flakes seen face-on [1/m]
    S         (3, 3) symmetric positive semidefinite, dimensionless: the squared projected areas of a flake; the
              identity makes the medium isotropic
    albedo    sigma_s / sigma_t in [0, 1], the same for every direction
    phase     phase function
    emission  emitted radiance L_e [W/(m^2 sr)]; the rendering equation multiplies it by sigma_a

    Source: Heitz, Dupuy, Crassin & Dachsbacher 2015, The SGGX microflake distribution, eq. 10.
    """

    sigma: Channels
    S: FloatArray
    albedo: Channels = 0.0
    phase: AnyPhaseField = field(default_factory=Isotropic)
    emission: Channels = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "sigma", nonnegative_channels("sigma", self.sigma, "1/m"))
        S = as_float_array("S", self.S)
        if S.shape != (3, 3):
            raise InvalidValueError("S", "must be a 3 x 3 matrix", list(S.shape))
        require("S", S, np.isfinite(S), "must be finite")
        require("S", S, S == S.T, "must be symmetric")
        lowest = np.linalg.eigvalsh(S)[:1]
        require("S", lowest, lowest >= -1e-14 * np.abs(S).max(), "must have no negative eigenvalue")
        object.__setattr__(self, "S", read_only(S))
        set_common(self)

    @property
    def is_empty(self) -> bool:
        """Whether there is vacuum everywhere."""
        return not (np.any(self.sigma) and np.any(self.S))

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return channels_with(self, sigma=self.sigma)
