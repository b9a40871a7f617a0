"""Things that cast shadows into a medium. They stand between a light and the ray, not between the camera and the medium."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from fogproof.scene.kinds import ByKind
from fogproof.scene.lights import one_direction, one_point
from fogproof.validate import number


@dataclass(frozen=True)
class Sphere:
    """An opaque ball.

    center  (x, y, z) [m]
    radius  [m], > 0
    """

    center: tuple[float, float, float]
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", one_point("center", self.center))
        object.__setattr__(self, "radius", _radius(self.radius))


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
        object.__setattr__(self, "radius", _radius(self.radius))


Occluder = Sphere | Disk
OCCLUDERS: dict[str, type[Occluder]] = {"sphere": Sphere, "disk": Disk}
"""The `kind` of each occluder in files and requests."""

OccluderField = Annotated[Occluder, ByKind(OCCLUDERS)]


def _radius(value: float) -> float:
    return number("radius", value, "must be finite and > 0 [m]", 0, math.inf, open_ends=True)
