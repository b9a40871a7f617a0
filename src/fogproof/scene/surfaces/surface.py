"""A surface: a place, and how it reflects and glows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from fogproof.errors import InvalidValueError
from fogproof.scene.occluders import Sphere
from fogproof.scene.surfaces.plane import Plane
from fogproof.validate import number

Place = Plane | Sphere
"""Where surfaces can be."""

Finish = Literal["lambert", "mirror"]
"""How a surface reflects: equally into all directions, or like a mirror."""


@dataclass(frozen=True)
class Surface:
    """A grey surface.

    place     a plane or a sphere
    albedo    share of the light that it reflects, in [0, 1]
    finish    "lambert" or "mirror"
    radiance  that it emits, the same in all directions [W/(m^2 sr)]
    """

    place: Place
    albedo: float = 0.0
    finish: Finish = "lambert"
    radiance: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.place, Place):
            raise InvalidValueError("place", "must be a Plane or a Sphere", self.place)
        if self.finish not in get_args(Finish):
            raise InvalidValueError("finish", f"must be one of {', '.join(get_args(Finish))}", self.finish)
        object.__setattr__(self, "albedo", number("albedo", self.albedo, "must lie in [0, 1]", 0, 1))
        rule = "must be finite and >= 0 [W/(m^2 sr)]"
        object.__setattr__(self, "radiance", number("radiance", self.radiance, rule, 0))
