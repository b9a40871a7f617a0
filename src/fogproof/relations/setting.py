"""What a renderer is asked for, and what two answers must have in common."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

from fogproof.scene import AnyMedium, Ray
from fogproof.scene.lights import Light
from fogproof.scene.shapes import Shape
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


@dataclass(frozen=True, eq=False)
class RadianceTerm:
    """A factor times the radiance of a setting, or of one of its channels."""

    setting: PathSetting
    factor: float = 1.0
    channel: int | None = None


@dataclass(frozen=True, eq=False)
class Comparison:
    """Two sums of terms that must average to the same.

    name      of the relation
    isolates  where to look if it fails
    """

    name: str
    isolates: str
    first: tuple[RadianceTerm, ...]
    second: tuple[RadianceTerm, ...]
