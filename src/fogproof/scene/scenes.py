"""A scene: a medium, the ray that looks through it, what lights it, and how far scattering is followed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from fogproof.errors import InvalidValueError
from fogproof.scene.lights import Light, LightField, strength
from fogproof.scene.media import AnyMedium, AnyMediumField
from fogproof.scene.occluders import Occluder, OccluderField
from fogproof.scene.rays import Ray
from fogproof.validate import Channels, channel_count, nonnegative_channels

Scattering = Literal["none", "ambient", "single"]
"""The levels of the lecture: no in-scattering, a constant ambient, one bounce from the light."""


@dataclass(frozen=True, eq=False)
class Scene:
    """What a camera ray sees.

    medium      what the ray crosses
    ray         camera rays of shape R
    scattering  how far in-scattering is followed: "none", "ambient" or "single"
    light       needed by "single": point, spot or directional light, or a constant environment
    occluders   what stands between the light and the ray; the camera sees past it
    ambient     in-scattered radiance L_i [W/(m^2 sr)] that "ambient" takes as constant
    background  radiance of the surface at the ray's end [W/(m^2 sr)]
    """

    medium: AnyMediumField
    ray: Ray
    scattering: Scattering = "none"
    light: LightField | None = None
    occluders: tuple[OccluderField, ...] = ()
    ambient: Channels = 0.0
    background: Channels = 0.0

    def __post_init__(self) -> None:
        if self.scattering not in get_args(Scattering):
            raise InvalidValueError("scattering", f"must be one of {', '.join(get_args(Scattering))}", self.scattering)
        object.__setattr__(self, "ambient", nonnegative_channels("ambient", self.ambient, "W/(m^2 sr)"))
        object.__setattr__(self, "background", nonnegative_channels("background", self.background, "W/(m^2 sr)"))
        if self.scattering == "single" and self.light is None:
            raise InvalidValueError(
                "light",
                "must be given when scattering is 'single'",
                None,
                "add a [light] table, or set scattering = 'none'",
            )
        for occluder in self.occluders:
            if not isinstance(occluder, Occluder):
                raise InvalidValueError("occluders", "must be spheres and disks", occluder)
        object.__setattr__(self, "occluders", tuple(self.occluders))
        if self.light is not None and not isinstance(self.light, Light):
            raise InvalidValueError(
                "light", "must be a light", self.light, "for example PointLight(position, intensity)"
            )
        if not isinstance(self.medium, AnyMedium):
            raise InvalidValueError("medium", "must be a medium", self.medium, "for example Medium(sigma_a, sigma_s)")
        _ = self.channels

    @property
    def channels(self) -> int | None:
        """How many channels medium, light, ambient and background have together; None if all are grey."""
        return channel_count(
            medium=(0.0,) * self.medium.channels if self.medium.channels else 0.0,
            light=strength(self.light) if self.light else 0.0,
            ambient=self.ambient,
            background=self.background,
        )
