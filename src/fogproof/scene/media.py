"""Participating media. Coefficients are in 1/m; a tuple has one value a colour or wavelength channel.

The homogeneous `Medium` is given by sigma_a and sigma_s, the others by sigma_t and the albedo sigma_s / sigma_t. A
medium fills space; where a kind has bounds, there is vacuum outside. Positions are world coordinates [m].
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from fogproof.scene.graded_media import AnisotropicMedium, ExponentialMedium, LinearMedium, PiecewiseConstantMedium
from fogproof.scene.kinds import ByKind
from fogproof.scene.opengl_fog import OpenGLFog
from fogproof.scene.phase import Isotropic, PhaseFunctionField, require_phase
from fogproof.scene.procedural import Procedural
from fogproof.scene.voxel_grid import VoxelGrid
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
        return np.divide(self.sigma_s, sigma_t, out=np.zeros_like(sigma_t), where=sigma_t > 0)

    @property
    def mean_free_path(self) -> np.ndarray:
        """1 / sigma_t [m], () or (channels,); inf where the medium is empty."""
        sigma_t = self.sigma_t
        return np.divide(1.0, sigma_t, out=np.full_like(sigma_t, np.inf), where=sigma_t > 0)


MEDIA: dict[str, type] = {
    "homogeneous": Medium,
    "linear": LinearMedium,
    "exponential": ExponentialMedium,
    "piecewise-constant": PiecewiseConstantMedium,
    "anisotropic": AnisotropicMedium,
    "opengl-fog": OpenGLFog,
    "voxel-grid": VoxelGrid,
}
"""The `kind` of each medium in files and requests; without one a medium is homogeneous."""

AnyMedium = (
    Medium
    | LinearMedium
    | ExponentialMedium
    | PiecewiseConstantMedium
    | AnisotropicMedium
    | OpenGLFog
    | VoxelGrid
    | Procedural
)
AnyMediumField = Annotated[AnyMedium, ByKind(MEDIA, default="homogeneous")]
