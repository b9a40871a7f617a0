"""The constant environment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fogproof.validate import Channels, nonnegative_channels


@dataclass(frozen=True)
class Environment:
    """The same radiance from all directions, from outside of what holds the medium.

    radiance  [W/(m^2 sr)], grey or one value a channel
    """

    radiance: Channels
    strength_field: ClassVar[str] = "radiance"
    distant: ClassVar[bool] = True
    delta: ClassVar[bool] = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "radiance", nonnegative_channels("radiance", self.radiance, "W/(m^2 sr)"))
