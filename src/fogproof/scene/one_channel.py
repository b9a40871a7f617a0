"""A coloured scene is as many grey ones: estimators that follow one channel serve it through this."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

from fogproof.scene.image_scenes import ImageScene
from fogproof.scene.lights import strength, with_strength
from fogproof.scene.media import medium_of_channel
from fogproof.scene.scenes import Scene

AnyScene = TypeVar("AnyScene", Scene, ImageScene)


def one_channel(scene: AnyScene, c: int) -> AnyScene:
    """Return the grey scene that channel c sees."""
    return replace(
        scene,
        medium=medium_of_channel(scene.medium, c),
        light=scene.light and with_strength(scene.light, _value(strength(scene.light), c)),
        ambient=_value(scene.ambient, c),
        background=_value(scene.background, c),
    )


def _value(value: Any, c: int) -> Any:
    return value[c] if isinstance(value, tuple) else value
