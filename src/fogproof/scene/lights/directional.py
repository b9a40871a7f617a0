"""Parallel light."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fogproof.validate import Channels, nonnegative_channels, one_direction


@dataclass(frozen=True)
class DirectionalLight:
    """Parallel light, as from the sun, from outside of what holds the medium.

    direction   unit vector in which the light travels
    irradiance  on a plane normal to it [W/m^2], grey or one value a channel
    """

    direction: tuple[float, float, float]
    irradiance: Channels
    strength_field: ClassVar[str] = "irradiance"
    distant: ClassVar[bool] = True
    delta: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", one_direction("direction", self.direction))
        object.__setattr__(self, "irradiance", nonnegative_channels("irradiance", self.irradiance, "W/m^2"))
