"""Scenes as plain frozen data that validate themselves. No formula lives here."""

from fogproof.scene.graded_media import (
    AnisotropicMedium,
    ExponentialMedium,
    LinearMedium,
    PiecewiseConstantMedium,
)
from fogproof.scene.lights import PointLight
from fogproof.scene.media import AnyMedium, Medium
from fogproof.scene.opengl_fog import OpenGLFog
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
from fogproof.scene.procedural import Procedural
from fogproof.scene.rays import Ray
from fogproof.scene.scenes import Scattering, Scene
from fogproof.scene.varying_phase import Ramp, VaryingPhase
from fogproof.scene.voxel_grid import VoxelGrid

__all__ = [
    "AnisotropicMedium",
    "AnyMedium",
    "CornetteShanks",
    "DoubleHenyeyGreenstein",
    "Draine",
    "ExponentialMedium",
    "Hazy",
    "HenyeyGreenstein",
    "Isotropic",
    "LinearMedium",
    "Medium",
    "Mie",
    "Mixture",
    "Murky",
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
    "Tabulated",
    "VaryingPhase",
    "VoxelGrid",
]
