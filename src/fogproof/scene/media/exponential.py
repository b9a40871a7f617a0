"""A medium whose extinction grows exponentially, as an isothermal atmosphere does."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from fogproof.scene.arrays import FloatArray
from fogproof.scene.media.common import channel_of, channels_with, row, set_common, set_vectors, vector_of
from fogproof.scene.phase import AnyPhaseField, Isotropic
from fogproof.validate import Channels, nonnegative_channels


@dataclass(frozen=True, eq=False)
class ExponentialMedium:
    """Extinction that grows exponentially: sigma_t(x) = sigma_0 exp(rate . x), as in an isothermal atmosphere.

    sigma_0   value at x = 0 [1/m], >= 0
    rate      (3,), or (channels, 3) with one a channel [1/m]: (0, 0, -1/H) for a scale height H along z
    albedo    sigma_s / sigma_t in [0, 1], the same everywhere
    phase     phase function
    emission  emitted radiance L_e [W/(m^2 sr)]; the rendering equation multiplies it by sigma_a
    """

    sigma_0: Channels
    rate: FloatArray
    albedo: Channels = 0.0
    phase: AnyPhaseField = field(default_factory=Isotropic)
    emission: Channels = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "sigma_0", nonnegative_channels("sigma_0", self.sigma_0, "1/m"))
        set_vectors(self, "rate", "1/m")
        set_common(self)

    @property
    def is_empty(self) -> bool:
        """Whether there is vacuum everywhere."""
        return not np.any(self.sigma_0)

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return channels_with(self, sigma_0=self.sigma_0, rate=row(self.rate))

    def channel(self, c: int) -> ExponentialMedium:
        """Return the grey medium that channel c sees."""
        sources = {name: channel_of(getattr(self, name), c) for name in ("sigma_0", "albedo", "emission")}
        return replace(self, rate=vector_of(self.rate, c), **sources)
