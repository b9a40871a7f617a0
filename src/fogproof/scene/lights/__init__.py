"""Lights. Intensities are radiant intensities in W/sr: an isotropic source of flux Phi has Phi / (4 pi).

Each kind is a module here, and says three things of itself:

    strength_field  the field that says how strong it is: "intensity" [W/sr], "irradiance" [W/m^2] or "radiance" [W/(m^2 sr)]
    distant         whether its light comes from outside of whatever holds the medium, from infinitely far
    delta           whether it arrives from single directions, so that a path never meets it by itself
"""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fogproof.scene.kinds import ByKind
from fogproof.scene.lights.directional import DirectionalLight
from fogproof.scene.lights.disk import DiskLight
from fogproof.scene.lights.environment import Environment
from fogproof.scene.lights.environment_map import EnvironmentMap
from fogproof.scene.lights.point import PointLight
from fogproof.scene.lights.rectangle import RectangleLight
from fogproof.scene.lights.sphere import SphereLight
from fogproof.scene.lights.spot import SpotLight
from fogproof.validate import Channels

__all__ = [
    "DirectionalLight",
    "DiskLight",
    "Environment",
    "EnvironmentMap",
    "Light",
    "PointLight",
    "RectangleLight",
    "SphereLight",
    "SpotLight",
]

Light = (
    PointLight | SpotLight | DirectionalLight | Environment | EnvironmentMap | SphereLight | RectangleLight | DiskLight
)
KINDS: dict[str, type[Light]] = {
    "point": PointLight,
    "spot": SpotLight,
    "directional": DirectionalLight,
    "environment": Environment,
    "environment-map": EnvironmentMap,
    "sphere": SphereLight,
    "rectangle": RectangleLight,
    "disk": DiskLight,
}
"""The `kind` of each light in files and requests; without one a light is a point."""

LightField = Annotated[Light, ByKind("fogproof.scene.lights", default="point")]


def strength(light: Light) -> Channels:
    """Return the intensity, irradiance or radiance of a light."""
    value: Channels = getattr(light, light.strength_field)
    return value


def with_strength(light: Light, value: Channels) -> Light:
    """Return the same light with another intensity, irradiance or radiance."""
    return replace(light, **{light.strength_field: value})  # type: ignore[arg-type]
