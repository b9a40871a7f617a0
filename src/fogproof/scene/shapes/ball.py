"""The ball."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.validate import one_point, positive_length


@dataclass(frozen=True)
class Ball:
    """The points within a sphere.

    center  (x, y, z) [m]
    radius  [m], > 0
    """

    center: tuple[float, float, float]
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", one_point("center", self.center))
        object.__setattr__(self, "radius", positive_length("radius", self.radius))

    @property
    def bounds(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Corners of a box around it [m]."""
        return tuple(x - self.radius for x in self.center), tuple(x + self.radius for x in self.center)
