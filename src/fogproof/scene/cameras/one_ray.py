"""The camera of one ray: every pixel shows the same, so that pixels are replicates of it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fogproof.scene.cameras.axes import checked_axes, checked_wall
from fogproof.scene.cameras.film import Film


@dataclass(frozen=True)
class OneRay:
    """The ray from `origin` through `target`, the same in each pixel.

    origin  (x, y, z) [m]
    target  (x, y, z) of a point on the ray [m]
    film    pixels
    up      vector that points up in a renderer that needs one
    wall    length of the ray [m]; inf: it ends nowhere
    """

    origin: tuple[float, float, float]
    target: tuple[float, float, float]
    film: Film
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    wall: float = math.inf

    def __post_init__(self) -> None:
        for name, value in zip(
            ("origin", "target", "up"), checked_axes(self.origin, self.target, self.up), strict=True
        ):
            object.__setattr__(self, name, value)
        object.__setattr__(self, "wall", checked_wall(self.wall))
