"""Scenes as plain frozen data that validate themselves. No formula lives here."""

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
from fogproof.scene.phase_functions import (
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
    Rayleigh,
    Schlick,
    Tabulated,
)
from fogproof.scene.rays import Ray
from fogproof.scene.scenes import Scattering, Scene
from fogproof.scene.shapes import Ball, Box, HalfSpace, Shape, Slab, Unbounded
from fogproof.scene.varying_phase import Ramp, VaryingPhase

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
