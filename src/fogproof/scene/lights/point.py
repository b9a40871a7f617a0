"""The isotropic point light."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fogproof.validate import Channels, nonnegative_channels, one_point


@dataclass(frozen=True)
class PointLight:
    """An isotropic point light.

    position   (x, y, z) [m]
    intensity  [W/sr], grey or one value a channel
    """

    position: tuple[float, float, float]
    intensity: Channels
    strength_field: ClassVar[str] = "intensity"
    distant: ClassVar[bool] = False
    delta: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", one_point("position", self.position))
        object.__setattr__(self, "intensity", nonnegative_channels("intensity", self.intensity, "W/sr"))
