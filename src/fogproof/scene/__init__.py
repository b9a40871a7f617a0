"""Scenes as plain frozen data that validate themselves. No formula lives here."""

from fogproof.scene import phase as _phase
from fogproof.scene.lights import DirectionalLight, Environment, Light, PointLight, SpotLight
from fogproof.scene.media import (
    AnisotropicMedium,
    AnyMedium,
    ExponentialMedium,
    LinearMedium,
    Medium,
    OpenGLFog,
    PiecewiseConstantMedium,
    Procedural,
    VoxelGrid,
)
from fogproof.scene.occluders import Disk, Occluder, Sphere
from fogproof.scene.phase import *  # noqa: F403
from fogproof.scene.rays import Ray
from fogproof.scene.scenes import Scattering, Scene
from fogproof.scene.shapes import Ball, Box, HalfSpace, Shape, Slab, Unbounded

__all__ = [
    "AnisotropicMedium",
    "AnyMedium",
    "Ball",
    "Box",
    "DirectionalLight",
    "Disk",
    "Environment",
    "ExponentialMedium",
    "HalfSpace",
    "Light",
    "LinearMedium",
    "Medium",
    "Occluder",
    "OpenGLFog",
    "PiecewiseConstantMedium",
    "PointLight",
    "Procedural",
    "Ray",
    "Scattering",
    "Scene",
    "Shape",
    "Slab",
    "Sphere",
    "SpotLight",
    "Unbounded",
    "VoxelGrid",
]
__all__ += _phase.__all__
