"""The sphere that shines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fogproof.validate import Channels, nonnegative_channels, one_point, positive_length


@dataclass(frozen=True)
class SphereLight:
    """A sphere that shines outwards from all of its surface, the same in all directions. It is opaque: a ray ends at it.

    center    (x, y, z) [m]
    radius    [m], > 0
    radiance  [W/(m^2 sr)], grey or one value a channel
    """

    center: tuple[float, float, float]
    radius: float
    radiance: Channels
    strength_field: ClassVar[str] = "radiance"
    distant: ClassVar[bool] = False
    delta: ClassVar[bool] = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", one_point("center", self.center))
        object.__setattr__(self, "radius", positive_length("radius", self.radius))
        object.__setattr__(self, "radiance", nonnegative_channels("radiance", self.radiance, "W/(m^2 sr)"))
