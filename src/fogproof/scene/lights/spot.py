"""The spot light: a point light that shines into a cone."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal, get_args

from fogproof.errors import InvalidValueError
from fogproof.validate import Channels, nonnegative_channels, number, one_direction, one_point

SpotProfile = Literal["smoothstep", "linear"]


@dataclass(frozen=True)
class SpotLight:
    """A point light that shines into a cone: intensity cos(alpha)^exponent times a fall-off, alpha the angle from the axis.

    position       (x, y, z) [m]
    direction      unit vector along the axis, away from the light
    intensity      on the axis [W/sr], grey or one value a channel
    half_angle     of the cone [rad], in (0, pi]; no light beyond
    falloff_start  angle [rad] up to which the cone is full; from there to half_angle the intensity falls. None: a hard edge
    exponent       whole number >= 0, OpenGL's spot exponent; half_angle is at most pi/2 if it is not 0
    profile        how it falls: "smoothstep", x^2 (3 - 2 x) with x linear in the cosine, as in pbrt and Blender;
                   "linear", x itself linear in the angle, as in Mitsuba
    """

    position: tuple[float, float, float]
    direction: tuple[float, float, float]
    intensity: Channels
    half_angle: float
    falloff_start: float | None = None
    exponent: int = 0
    profile: SpotProfile = "smoothstep"
    strength_field: ClassVar[str] = "intensity"
    distant: ClassVar[bool] = False
    delta: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", one_point("position", self.position))
        object.__setattr__(self, "direction", one_direction("direction", self.direction))
        object.__setattr__(self, "intensity", nonnegative_channels("intensity", self.intensity, "W/sr"))
        half_angle = number("half_angle", self.half_angle, "must lie in (0, pi] [rad]", 0, math.pi)
        if not half_angle > 0:
            raise InvalidValueError("half_angle", "must lie in (0, pi] [rad]", half_angle)
        object.__setattr__(self, "half_angle", half_angle)
        if self.falloff_start is not None:
            start = number("falloff_start", self.falloff_start, "must lie in [0, half_angle] [rad]", 0, half_angle)
            object.__setattr__(self, "falloff_start", start)
        if isinstance(self.exponent, bool) or not isinstance(self.exponent, int) or self.exponent < 0:
            raise InvalidValueError("exponent", "must be a whole number >= 0", self.exponent)
        if self.exponent and half_angle > math.pi / 2:
            raise InvalidValueError(
                "half_angle", "must be at most pi/2 [rad] with an exponent", half_angle, "cos(alpha) is negative beyond"
            )
        if self.profile not in get_args(SpotProfile):
            raise InvalidValueError("profile", f"must be one of {', '.join(get_args(SpotProfile))}", self.profile)

    @classmethod
    def from_blender(
        cls,
        position: tuple[float, float, float],
        direction: tuple[float, float, float],
        intensity: Channels,
        size: float,
        blend: float,
    ) -> SpotLight:
        """Return the spot of Blender's Cycles with this `size` (the whole angle [rad], in (0, pi]) and `blend` in [0, 1].

        Its smoothstep begins where the cosine is cos(size/2) + blend (1 - cos(size/2)).
        """
        size = number("size", size, "must lie in (0, pi] [rad]", 0, math.pi)
        edge = math.cos(0.5 * size)
        full = edge + number("blend", blend, "must lie in [0, 1]", 0, 1) * (1 - edge)
        return cls(position, direction, intensity, 0.5 * size, min(math.acos(full), 0.5 * size))
