"""A medium whose extinction grows linearly, clamped at 0."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.media.common import channel_of, channels_with, row, set_common, set_vectors, vector_of
from fogproof.scene.phase import AnyPhaseField, Isotropic
from fogproof.validate import Channels, as_float_array, require


@dataclass(frozen=True, eq=False)
class LinearMedium:
    """Extinction that grows linearly: sigma_t(x) = max(0, sigma_0 + gradient . x).

    sigma_0   value at x = 0 [1/m]; it may be negative: where the sum is, there is vacuum
    gradient  (3,), or (channels, 3) with one a channel [1/m^2]
    albedo    sigma_s / sigma_t in [0, 1], the same everywhere
    phase     phase function
    emission  emitted radiance L_e [W/(m^2 sr)]; the rendering equation multiplies it by sigma_a
    """

    sigma_0: Channels
    gradient: FloatArray
    albedo: Channels = 0.0
    phase: AnyPhaseField = field(default_factory=Isotropic)
    emission: Channels = 0.0

    def __post_init__(self) -> None:
        sigma_0 = as_float_array("sigma_0", self.sigma_0)
        if sigma_0.ndim > 1 or sigma_0.size == 0:
            raise InvalidValueError("sigma_0", "must be a number or a list with one number a channel", self.sigma_0)
        require("sigma_0", sigma_0, np.isfinite(sigma_0), "must be finite [1/m]")
        object.__setattr__(self, "sigma_0", float(sigma_0) if sigma_0.ndim == 0 else tuple(sigma_0.tolist()))
        set_vectors(self, "gradient", "1/m^2")
        set_common(self)

    @property
    def is_empty(self) -> bool:
        """Whether there is vacuum everywhere."""
        return not np.any(np.greater(self.sigma_0, 0)) and not np.any(self.gradient)

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return channels_with(self, sigma_0=self.sigma_0, gradient=row(self.gradient))

    def channel(self, c: int) -> LinearMedium:
        """Return the grey medium that channel c sees."""
        sources = {name: channel_of(getattr(self, name), c) for name in ("sigma_0", "albedo", "emission")}
        return replace(self, gradient=vector_of(self.gradient, c), **sources)
