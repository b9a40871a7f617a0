"""The half space."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.validate import one_direction, one_point


@dataclass(frozen=True)
class HalfSpace:
    """The points on one side of a plane.

    point   (x, y, z) on the plane [m]
    normal  unit vector out of the medium
    """

    point: tuple[float, float, float]
    normal: tuple[float, float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", one_point("point", self.point))
        object.__setattr__(self, "normal", one_direction("normal", self.normal))
