"""A scene that is seen through a camera: what an image shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.cameras import Camera, CameraField
from fogproof.scene.lights import Light, LightField, strength
from fogproof.scene.media import AnyMedium, AnyMediumField
from fogproof.scene.occluders import Occluder, OccluderField
from fogproof.scene.shapes import EVERYWHERE, Shape, ShapeField
from fogproof.validate import Channels, channel_count, nonnegative_channels

ImageScattering = Literal["none", "ambient", "single", "multiple"]
"""How far in-scattering is followed: not at all, a constant, one bounce from the light, or to the end."""


@dataclass(frozen=True, eq=False)
class ImageScene:
    """What a camera sees.

    medium      what fills the shape, or all of space
    camera      perspective, orthographic or one ray
    scattering  "none", "ambient", "single" or "multiple"
    light       needed by "single" and "multiple"; a camera does not see it
    shape       convex region that a homogeneous medium fills, vacuum around it; all of space unless given
    occluders   what stands between the light and the rays; the camera sees past it
    ambient     in-scattered radiance L_i [W/(m^2 sr)] that "ambient" takes as constant
    background  radiance at the end of each ray, of the wall or the sky [W/(m^2 sr)]
    purpose     what the scene is for, in a sentence
    """

    medium: AnyMediumField
    camera: CameraField
    scattering: ImageScattering = "none"
    light: LightField | None = None
    shape: ShapeField = EVERYWHERE
    occluders: tuple[OccluderField, ...] = ()
    ambient: Channels = 0.0
    background: Channels = 0.0
    purpose: str = ""

    def __post_init__(self) -> None:
        if self.scattering not in get_args(ImageScattering):
            raise InvalidValueError(
                "scattering", f"must be one of {', '.join(get_args(ImageScattering))}", self.scattering
            )
        for name, kinds in (("medium", AnyMedium), ("camera", Camera), ("shape", Shape)):
            if not isinstance(getattr(self, name), kinds):
                raise InvalidValueError(name, f"must be a {name}", getattr(self, name))
        object.__setattr__(self, "ambient", nonnegative_channels("ambient", self.ambient, "W/(m^2 sr)"))
        object.__setattr__(self, "background", nonnegative_channels("background", self.background, "W/(m^2 sr)"))
        if self.light is not None and not isinstance(self.light, Light):
            raise InvalidValueError("light", "must be a light", self.light)
        if self.scattering in ("single", "multiple") and self.light is None:
            raise InvalidValueError(
                "light", f"must be given when scattering is '{self.scattering}'", None, "add a [light] table"
            )
        if not all(isinstance(occluder, Occluder) for occluder in self.occluders):
            raise InvalidValueError("occluders", "must be spheres and disks", self.occluders)
        object.__setattr__(self, "occluders", tuple(self.occluders))
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

    @property
    def dark(self) -> bool:
        """Whether no light is on, so that nothing but background, emission and ambient is seen."""
        return self.light is None or not np.any(strength(self.light))
