"""The endless plane."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.validate import one_direction, one_point


@dataclass(frozen=True)
class Plane:
    """An endless plane, seen from both sides.

    point   (x, y, z) on it [m]
    normal  unit vector, either side
    """

    point: tuple[float, float, float]
    normal: tuple[float, float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", one_point("point", self.point))
        object.__setattr__(self, "normal", one_direction("normal", self.normal))
