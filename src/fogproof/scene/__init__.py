"""Scenes as plain frozen data that validate themselves. No formula lives here."""

from fogproof.scene.lights import PointLight
from fogproof.scene.media import Medium
from fogproof.scene.phase_functions import HenyeyGreenstein, Isotropic, PhaseFunction, Rayleigh
from fogproof.scene.rays import Ray
from fogproof.scene.scenes import Scattering, Scene

__all__ = [
    "HenyeyGreenstein",
    "Isotropic",
    "Medium",
    "PhaseFunction",
    "PointLight",
    "Ray",
    "Rayleigh",
    "Scattering",
    "Scene",
]
