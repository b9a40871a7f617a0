"""The camera of parallel rays."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fogproof.scene.cameras.axes import checked_axes, checked_wall
from fogproof.scene.cameras.film import Film
from fogproof.validate import positive_length


@dataclass(frozen=True)
class Orthographic:
    """Parallel rays that start on a plane through `origin`, along the axis to `target`; pixels are square.

    origin  (x, y, z) of the film's middle [m]
    target  (x, y, z) of a point on the axis [m]
    width   of the whole film [m]
    film    pixels
    up      vector that points up in the image
    wall    distance of the plane across the axis on which rays end [m]; inf: none
    """

    origin: tuple[float, float, float]
    target: tuple[float, float, float]
    width: float
    film: Film
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    wall: float = math.inf

    def __post_init__(self) -> None:
        for name, value in zip(
            ("origin", "target", "up"), checked_axes(self.origin, self.target, self.up), strict=True
        ):
            object.__setattr__(self, name, value)
        object.__setattr__(self, "width", positive_length("width", self.width))
        object.__setattr__(self, "wall", checked_wall(self.wall))
