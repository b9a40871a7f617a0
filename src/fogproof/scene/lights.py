"""Lights. Intensities are radiant intensities in W/sr: an isotropic source of flux Phi has Phi / (4 pi)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from fogproof.errors import InvalidValueError
from fogproof.scene.kinds import ByKind
from fogproof.validate import Channels, nonnegative_channels, number, points, unit_vectors


@dataclass(frozen=True)
class PointLight:
    """An isotropic point light.

    position   (x, y, z) [m]
    intensity  [W/sr], grey or one value a channel
    """

    position: tuple[float, float, float]
    intensity: Channels

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", one_point("position", self.position))
        object.__setattr__(self, "intensity", nonnegative_channels("intensity", self.intensity, "W/sr"))


@dataclass(frozen=True)
class SpotLight:
    """A point light that shines into a cone: intensity cos(alpha)^exponent smoothstep, alpha the angle from the axis.

    position       (x, y, z) [m]
    direction      unit vector along the axis, away from the light
    intensity      on the axis [W/sr], grey or one value a channel
    half_angle     of the cone [rad], in (0, pi]; no light beyond
    falloff_start  angle [rad] up to which the cone is full; from there to half_angle the intensity falls as
                   x^2 (3 - 2 x), x linear in the cosine, as in pbrt. None: a hard edge at half_angle
    exponent       whole number >= 0, OpenGL's spot exponent; half_angle is at most pi/2 if it is not 0
    """

    position: tuple[float, float, float]
    direction: tuple[float, float, float]
    intensity: Channels
    half_angle: float
    falloff_start: float | None = None
    exponent: int = 0

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


@dataclass(frozen=True)
class DirectionalLight:
    """Parallel light, as from the sun, from outside of what holds the medium.

    direction   unit vector in which the light travels
    irradiance  on a plane normal to it [W/m^2], grey or one value a channel
    """

    direction: tuple[float, float, float]
    irradiance: Channels

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", one_direction("direction", self.direction))
        object.__setattr__(self, "irradiance", nonnegative_channels("irradiance", self.irradiance, "W/m^2"))


@dataclass(frozen=True)
class Environment:
    """The same radiance from all directions, from outside of what holds the medium.

    radiance  [W/(m^2 sr)], grey or one value a channel
    """

    radiance: Channels

    def __post_init__(self) -> None:
        object.__setattr__(self, "radiance", nonnegative_channels("radiance", self.radiance, "W/(m^2 sr)"))


Light = PointLight | SpotLight | DirectionalLight | Environment
LIGHTS: dict[str, type[Light]] = {
    "point": PointLight,
    "spot": SpotLight,
    "directional": DirectionalLight,
    "environment": Environment,
}
"""The `kind` of each light in files and requests; without one a light is a point."""

LightField = Annotated[Light, ByKind(LIGHTS, default="point")]


def strength(light: Light) -> Channels:
    """Return the intensity, irradiance or radiance of a light."""
    match light:
        case DirectionalLight():
            return light.irradiance
        case Environment():
            return light.radiance
    return light.intensity


def one_point(name: str, value: object) -> tuple[float, float, float]:
    """Return one finite point as a tuple."""
    point = points(name, value)
    if point.ndim != 1:
        raise InvalidValueError(name, "must be one point [x, y, z]", value)
    return tuple(point.tolist())


def one_direction(name: str, value: object) -> tuple[float, float, float]:
    """Return one unit vector as a tuple."""
    vector = unit_vectors(name, value)
    if vector.ndim != 1:
        raise InvalidValueError(name, "must be one vector [x, y, z]", value)
    return tuple(vector.tolist())
