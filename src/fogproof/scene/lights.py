"""Lights. Intensities are radiant intensities in W/sr: an isotropic source of flux Phi has Phi / (4 pi)."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.errors import InvalidValueError
from fogproof.validate import Channels, nonnegative_channels, points


@dataclass(frozen=True)
class PointLight:
    """An isotropic point light.

    position   (x, y, z) [m]
    intensity  [W/sr], grey or one value a channel
    """

    position: tuple[float, float, float]
    intensity: Channels

    def __post_init__(self) -> None:
        position = points("position", self.position)
        if position.ndim != 1:
            raise InvalidValueError("position", "must be one point [x, y, z]", self.position)
        object.__setattr__(self, "position", tuple(position.tolist()))
        object.__setattr__(self, "intensity", nonnegative_channels("intensity", self.intensity, "W/sr"))
