"""The flat disk."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.validate import one_direction, one_point, positive_length


@dataclass(frozen=True)
class Disk:
    """An opaque flat disk.

    center  (x, y, z) [m]
    normal  unit vector, either side
    radius  [m], > 0
    """

    center: tuple[float, float, float]
    normal: tuple[float, float, float]
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", one_point("center", self.center))
        object.__setattr__(self, "normal", one_direction("normal", self.normal))
        object.__setattr__(self, "radius", positive_length("radius", self.radius))
