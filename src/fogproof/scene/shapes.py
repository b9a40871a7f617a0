"""Convex shapes that hold a medium, with vacuum outside; `Unbounded` fills space."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from fogproof.errors import InvalidValueError
from fogproof.scene.kinds import ByKind
from fogproof.scene.lights import one_direction, one_point
from fogproof.validate import number


@dataclass(frozen=True)
class Unbounded:
    """All of space."""


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
        rule = "must be finite and > 0 [m]"
        object.__setattr__(self, "thickness", number("thickness", self.thickness, rule, 0, math.inf, open_ends=True))


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
        rule = "must be finite and > 0 [m]"
        object.__setattr__(self, "radius", number("radius", self.radius, rule, 0, math.inf, open_ends=True))


@dataclass(frozen=True)
class Box:
    """The points of a box along the axes.

    lower, upper  (x, y, z) corners [m]
    """

    lower: tuple[float, float, float]
    upper: tuple[float, float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "lower", one_point("lower", self.lower))
        object.__setattr__(self, "upper", one_point("upper", self.upper))
        if not all(low < high for low, high in zip(self.lower, self.upper, strict=True)):
            raise InvalidValueError("upper", f"must be above lower = {self.lower} on each axis", self.upper)


Shape = Unbounded | HalfSpace | Slab | Ball | Box
SHAPES: dict[str, type[Shape]] = {
    "unbounded": Unbounded,
    "half-space": HalfSpace,
    "slab": Slab,
    "ball": Ball,
    "box": Box,
}
"""The `kind` of each shape in files and requests."""

ShapeField = Annotated[Shape, ByKind(SHAPES)]
