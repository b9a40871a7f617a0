"""What a renderer is asked for, and what two answers must have in common."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Literal

import numpy as np

from fogproof.scene import AnyMedium, ImageScene, Medium, Ray
from fogproof.scene.lights import Light, strength, with_strength
from fogproof.scene.media import medium_of_channel
from fogproof.scene.one_channel import one_channel
from fogproof.scene.shapes import EVERYWHERE, Shape
from fogproof.scene.surfaces import Surface


@dataclass(frozen=True, eq=False)
class PathSetting:
    """Radiance along one ray through a medium, scattered any number of times.

    medium, shape   what fills the convex shape; vacuum outside
    ray             one camera ray
    light, surface  what shines, what stands in or behind the medium
    light_sampling  the integrator: "nee", "bsdf" (the light is met by chance), "mis", or None for the renderer's choice
    majorant        bound of sigma_t for tracking [1/m], None for the renderer's own
    deepest         greatest scattering order, None for all
    only            the one scattering order that counts, None for all
    """

    medium: AnyMedium
    shape: Shape
    ray: Ray
    light: Light | None = None
    surface: Surface | None = None
    light_sampling: Literal["nee", "bsdf", "mis"] | None = None
    majorant: float | None = None
    deepest: int | None = None
    only: int | None = None

    def but(self, **changes: Any) -> PathSetting:
        """Return the setting with some fields changed."""
        return replace(self, **changes)

    def alone(self, channel: int) -> PathSetting:
        """Return the grey setting that a channel sees."""
        light = self.light
        value = 0.0 if light is None else strength(light)
        if light is not None and isinstance(value, tuple):
            light = with_strength(light, value[channel])
        return replace(self, medium=medium_of_channel(self.medium, channel), light=light)


@dataclass(frozen=True, eq=False)
class ImageSetting:
    """An image of a scene.

    scene       what is seen
    integrator  the renderer's way to render it, "" for its own choice
    threads     how many it may use, 0 for its own choice
    more        how many times as many samples a pixel as usual
    copy        which of several images of it, each of its own seeds
    """

    scene: ImageScene
    integrator: str = ""
    threads: int = 0
    more: int = 1
    copy: int = 0

    surface: ClassVar[None] = None
    only: ClassVar[None] = None

    @property
    def medium(self) -> AnyMedium:
        """What fills the shape."""
        return self.scene.medium

    @property
    def shape(self) -> Shape:
        """What the medium fills."""
        return self.scene.shape

    @property
    def light(self) -> Light | None:
        """What shines."""
        return self.scene.light

    def but(self, **changes: Any) -> ImageSetting:
        """Return the setting with some fields changed, its own or the scene's; a medium with bounds of its own has no shape."""
        own = {name: changes.pop(name) for name in [field.name for field in fields(self)] if name in changes}
        if not isinstance(changes.get("medium", self.medium), Medium):
            changes["shape"] = EVERYWHERE
        return replace(self, **{"scene": replace(self.scene, **changes), **own})

    def alone(self, channel: int) -> ImageSetting:
        """Return the grey setting that a channel sees."""
        return replace(self, scene=one_channel(self.scene, channel))


@dataclass(frozen=True, eq=False)
class RadianceTerm:
    """A factor times the radiance of a setting, or of one of its channels.

    setting  None: radiance 1
    view     what of an image counts: an array (rows, columns, channels) -> such an array; None: all
    """

    setting: Any
    factor: float = 1.0
    channel: int | None = None
    view: Callable[[np.ndarray], np.ndarray] | None = None


@dataclass(frozen=True, eq=False)
class Comparison:
    """Two sums of terms that must average to the same.

    name      of the relation
    isolates  where to look if it fails
    same_law  whether both sides have the same law, not only the same mean
    """

    name: str
    isolates: str
    first: tuple[RadianceTerm, ...]
    second: tuple[RadianceTerm, ...]
    same_law: bool = False
