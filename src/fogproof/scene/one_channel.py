"""A coloured scene is as many grey ones: estimators that follow one channel serve it through this."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.scene.graded_media import AnisotropicMedium, ExponentialMedium, LinearMedium, PiecewiseConstantMedium
from fogproof.scene.lights import strength, with_strength
from fogproof.scene.media import AnyMedium, Medium
from fogproof.scene.opengl_fog import OpenGLFog
from fogproof.scene.procedural import Procedural
from fogproof.scene.scenes import Scene
from fogproof.scene.voxel_grid import VoxelGrid


def one_channel(scene: Scene, c: int) -> Scene:
    """Return the grey scene that channel c sees."""
    return replace(
        scene,
        medium=medium_of_channel(scene.medium, c),
        light=scene.light and with_strength(scene.light, _value(strength(scene.light), c)),
        ambient=_value(scene.ambient, c),
        background=_value(scene.background, c),
    )


def medium_of_channel(medium: AnyMedium, c: int) -> AnyMedium:
    """Return the grey medium that channel c of a medium sees; a grey medium is returned as it is."""
    if medium.channels is None:
        return medium
    match medium:
        case Medium():
            names = ("sigma_a", "sigma_s", "emission")
            return replace(medium, **{name: _value(getattr(medium, name), c) for name in names})
        case LinearMedium():
            return _graded(medium, c, sigma_0=_value(medium.sigma_0, c), gradient=_vector(medium.gradient, c))
        case ExponentialMedium():
            return _graded(medium, c, sigma_0=_value(medium.sigma_0, c), rate=_vector(medium.rate, c))
        case AnisotropicMedium():
            return _graded(medium, c, sigma=_value(medium.sigma, c))
        case OpenGLFog():
            return _graded(medium, c)
        case PiecewiseConstantMedium() | VoxelGrid():
            axes = 1 if isinstance(medium, PiecewiseConstantMedium) else 3
            return _graded_cells(medium, axes, c)
        case Procedural(channels=None):
            return _graded(medium, c)
    field = medium.sigma_t
    return _graded(medium, c, sigma_t=lambda *at: np.asarray(field(*at))[..., c], channels=None)


def _graded(medium: Any, c: int, **more: Any) -> Any:
    return replace(medium, albedo=_value(medium.albedo, c), emission=_value(medium.emission, c), **more)


def _graded_cells(medium: Any, axes: int, c: int) -> Any:
    values = {name: getattr(medium, name) for name in ("sigma_t", "albedo", "emission")}
    return replace(medium, **{name: v[..., c] if np.ndim(v) > axes else v for name, v in values.items()})


def _value(value: Any, c: int) -> Any:
    return value[c] if isinstance(value, tuple) else value


def _vector(vectors: np.ndarray, c: int) -> np.ndarray:
    return vectors[c] if vectors.ndim == 2 else vectors
