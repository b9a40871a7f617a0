"""The pinhole camera."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

from fogproof.errors import InvalidValueError
from fogproof.scene.cameras.axes import checked_axes, checked_wall
from fogproof.scene.cameras.film import Film
from fogproof.validate import number

FovAxis = Literal["x", "y", "smaller", "larger", "diagonal"]


@dataclass(frozen=True)
class Perspective:
    """A pinhole at `origin` that looks at `target`; the film's middle is on the axis, its pixels are square.

    origin    (x, y, z) of the pinhole [m]
    target    (x, y, z) of a point on the axis [m]
    fov       whole angle of view along `fov_axis` [rad], in (0, pi)
    film      pixels
    up        vector that points up in the image
    fov_axis  the side of the whole film that `fov` spans: "x" the width, "y" the height, "smaller" or "larger" of the two,
              or "diagonal"
    wall      distance of the plane across the axis on which rays end [m]; inf: none
    """

    origin: tuple[float, float, float]
    target: tuple[float, float, float]
    fov: float
    film: Film
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    fov_axis: FovAxis = "x"
    wall: float = math.inf

    def __post_init__(self) -> None:
        for name, value in zip(
            ("origin", "target", "up"), checked_axes(self.origin, self.target, self.up), strict=True
        ):
            object.__setattr__(self, name, value)
        object.__setattr__(
            self, "fov", number("fov", self.fov, "must lie in (0, pi) [rad]", 0, math.pi, open_ends=True)
        )
        object.__setattr__(self, "wall", checked_wall(self.wall))
        if self.fov_axis not in get_args(FovAxis):
            raise InvalidValueError("fov_axis", f"must be one of {', '.join(get_args(FovAxis))}", self.fov_axis)

    @property
    def half_width(self) -> float:
        """Half the width of the film at distance 1: the tangent of half the horizontal angle of view."""
        width, height = self.film.width, self.film.height
        spanned = {
            "x": width,
            "y": height,
            "smaller": min(width, height),
            "larger": max(width, height),
            "diagonal": math.hypot(width, height),
        }[self.fov_axis]
        return math.tan(0.5 * self.fov) * width / spanned
