"""Scenes as plain frozen data that validate themselves. No formula lives here."""

from fogproof.scene.graded_media import (
    AnisotropicMedium,
    ExponentialMedium,
    LinearMedium,
    PiecewiseConstantMedium,
)
from fogproof.scene.lights import DirectionalLight, Environment, Light, PointLight, SpotLight
from fogproof.scene.media import AnyMedium, Medium
from fogproof.scene.occluders import Disk, Occluder, Sphere
from fogproof.scene.opengl_fog import OpenGLFog
from fogproof.scene.phase import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    Mie,
    Mixture,
    Murky,
    PhaseFunction,
    Ramp,
    Rayleigh,
    Schlick,
    Tabulated,
    VaryingPhase,
)
from fogproof.scene.procedural import Procedural
from fogproof.scene.rays import Ray
from fogproof.scene.scenes import Scattering, Scene
from fogproof.scene.shapes import Ball, Box, HalfSpace, Shape, Slab, Unbounded
from fogproof.scene.voxel_grid import VoxelGrid

__all__ = [
    "AnisotropicMedium",
    "AnyMedium",
    "Ball",
    "Box",
    "CornetteShanks",
    "DirectionalLight",
    "Disk",
    "DoubleHenyeyGreenstein",
    "Draine",
    "Environment",
    "ExponentialMedium",
    "HalfSpace",
    "Hazy",
    "HenyeyGreenstein",
    "Isotropic",
    "Light",
    "LinearMedium",
    "Medium",
    "Mie",
    "Mixture",
    "Murky",
    "Occluder",
    "OpenGLFog",
    "PhaseFunction",
    "PiecewiseConstantMedium",
    "PointLight",
    "Procedural",
    "Ramp",
    "Ray",
    "Rayleigh",
    "Scattering",
    "Scene",
    "Schlick",
    "Shape",
    "Slab",
    "Sphere",
    "SpotLight",
    "Tabulated",
    "Unbounded",
    "VaryingPhase",
    "VoxelGrid",
]
