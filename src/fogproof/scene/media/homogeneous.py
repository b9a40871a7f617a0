"""The homogeneous medium, given by sigma_a and sigma_s."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fogproof.scene.phase import Isotropic, PhaseFunctionField, require_phase
from fogproof.validate import Channels, channel_count, nonnegative_channels, require


@dataclass(frozen=True)
class Medium:
    """A homogeneous medium.

    sigma_a   absorption coefficient [1/m]
    sigma_s   scattering coefficient [1/m]
    phase     phase function
    emission  emitted radiance L_e [W/(m^2 sr)]; the rendering equation multiplies it by sigma_a
    """

    sigma_a: Channels
    sigma_s: Channels
    phase: PhaseFunctionField = field(default_factory=Isotropic)
    emission: Channels = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "sigma_a", nonnegative_channels("sigma_a", self.sigma_a, "1/m"))
        object.__setattr__(self, "sigma_s", nonnegative_channels("sigma_s", self.sigma_s, "1/m"))
        object.__setattr__(self, "emission", nonnegative_channels("emission", self.emission, "W/(m^2 sr)"))
        require_phase("phase", self.phase)
        channel_count(sigma_a=self.sigma_a, sigma_s=self.sigma_s, emission=self.emission)
        with np.errstate(over="ignore"):
            require("sigma_t", self.sigma_t, np.isfinite(self.sigma_t), "= sigma_a + sigma_s must be finite [1/m]")

    @property
    def is_empty(self) -> bool:
        """Whether there is vacuum everywhere."""
        return not np.any(self.sigma_t)

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return channel_count(sigma_a=self.sigma_a, sigma_s=self.sigma_s, emission=self.emission)

    @property
    def sigma_t(self) -> np.ndarray:
        """Extinction coefficient sigma_a + sigma_s [1/m], () or (channels,)."""
        return np.add(self.sigma_a, self.sigma_s)

    @property
    def albedo(self) -> np.ndarray:
        """Single-scattering albedo sigma_s / sigma_t, () or (channels,); 0 where the medium is empty."""
        sigma_t = self.sigma_t
        share: np.ndarray = np.divide(self.sigma_s, sigma_t, out=np.zeros_like(sigma_t), where=sigma_t > 0)
        return share

    @property
    def mean_free_path(self) -> np.ndarray:
        """1 / sigma_t [m], () or (channels,); inf where the medium is empty."""
        sigma_t = self.sigma_t
        way: np.ndarray = np.divide(1.0, sigma_t, out=np.full_like(sigma_t, np.inf), where=sigma_t > 0)
        return way
