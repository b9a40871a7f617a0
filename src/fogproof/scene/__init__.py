"""Scenes as plain frozen data that validate themselves. No formula lives here."""

from fogproof.scene.lights import PointLight
from fogproof.scene.media import Medium
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

__all__ = [
    "CornetteShanks",
    "DoubleHenyeyGreenstein",
    "Draine",
    "Hazy",
    "HenyeyGreenstein",
    "Isotropic",
    "Medium",
    "Mie",
    "Mixture",
    "Murky",
    "PhaseFunction",
    "PointLight",
    "Ray",
    "Rayleigh",
    "Scattering",
    "Scene",
    "Schlick",
    "Tabulated",
]
