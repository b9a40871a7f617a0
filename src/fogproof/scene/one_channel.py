"""A coloured scene is as many grey ones: estimators that follow one channel serve it through this."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fogproof.scene.lights import DirectionalLight, Environment, Light, PointLight, SpotLight
from fogproof.scene.media import medium_of_channel
from fogproof.scene.scenes import Scene


def one_channel(scene: Scene, c: int) -> Scene:
    """Return the grey scene that channel c sees."""
    return replace(
        scene,
        medium=medium_of_channel(scene.medium, c),
        light=None if scene.light is None else _light(scene.light, c),
        ambient=_value(scene.ambient, c),
        background=_value(scene.background, c),
    )


def _light(light: Light, c: int) -> Light:
    match light:
        case PointLight() | SpotLight():
            return replace(light, intensity=_value(light.intensity, c))
        case DirectionalLight():
            return replace(light, irradiance=_value(light.irradiance, c))
    assert isinstance(light, Environment)
    return replace(light, radiance=_value(light.radiance, c))


def _value(value: Any, c: int) -> Any:
    return value[c] if isinstance(value, tuple) else value
