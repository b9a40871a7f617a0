"""The plane-parallel slab."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fogproof.validate import one_direction, one_point, positive_length


@dataclass(frozen=True)
class Slab:
    """The points between two parallel planes.

    point      (x, y, z) on one of them [m]
    normal     unit vector out of the medium there
    thickness  [m], > 0
    """

    point: tuple[float, float, float]
    normal: tuple[float, float, float]
    thickness: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", one_point("point", self.point))
        object.__setattr__(self, "normal", one_direction("normal", self.normal))
        object.__setattr__(self, "thickness", positive_length("thickness", self.thickness))

    @property
    def bounds(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Corners of a box around it [m]; infinite across a normal that is no axis."""
        low, high = [-math.inf] * 3, [math.inf] * 3
        for axis, n in enumerate(self.normal):
            if abs(n) == 1:
                low[axis], high[axis] = sorted((self.point[axis], self.point[axis] - n * self.thickness))
        return tuple(low), tuple(high)
