"""Arguments of the solutions for multiple scattering, checked once. Lengths are in mean free paths: sigma_t times metres."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.phase import Isotropic, PhaseFunction, require_phase
from fogproof.validate import as_float_array, require


def checked_albedo(albedo: Any) -> np.ndarray:
    """Return single-scattering albedos sigma_s / sigma_t in [0, 1]."""
    array = as_float_array("albedo", albedo)
    require("albedo", array, (array >= 0) & (array <= 1), "must lie in [0, 1]", "it is sigma_s / sigma_t")
    return array


def checked_cosine(name: str, mu: Any) -> np.ndarray:
    """Return cosines to a surface normal in (0, 1]."""
    array = as_float_array(name, mu)
    require(name, array, (array > 0) & (array <= 1), "must lie in (0, 1]", "it is the cosine to the surface normal")
    return array


GRAZING = 1e-20
"""Cosine, over the thickness or 1, below which a slab looks as it does along its surface, to the last digit."""


DEEPEST = 1e25
"""Thickness beyond which a slab reflects what a half space does, and passes nothing or, if nothing is absorbed, 1/tau."""


def seen_at(mu: np.ndarray, tau: np.ndarray | float, grazing: float = GRAZING) -> np.ndarray:
    """Return the cosines at which to look at what slabs of thickness tau scatter: never closer to their surface than counts.

    What is scattered changes with mu like mu ln(mu)/tau there, relatively.
    """
    return np.maximum(mu, grazing * np.minimum(tau, 1.0))


def checked_length(name: str, value: Any) -> np.ndarray:
    """Return finite lengths >= 0 in mean free paths."""
    array = as_float_array(name, value)
    require(name, array, (array >= 0) & np.isfinite(array), "must be finite and >= 0 [mean free paths]")
    return array


MOST = 10_000
"""Scattering orders asked for at most: as many values, and solutions to find them, have to fit into memory."""


def checked_count(name: str, value: Any, most: int = MOST) -> int:
    """Return a whole number in [0, most]."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not 0 <= value <= most:
        raise InvalidValueError(name, f"must be a whole number in [0, {most}]", value)
    return int(value)


def checked_phase(phase: Any) -> PhaseFunction:
    """Return the phase function, isotropic where none is given."""
    if phase is None:
        return Isotropic()
    require_phase("phase", phase)
    return phase


def checked_azimuth(azimuth: Any, isotropic: bool) -> np.ndarray:
    """Return azimuths between two ways [rad]; they may be left out where scattering is isotropic."""
    if azimuth is None and not isotropic:
        raise InvalidValueError("azimuth", "must be given [rad]", azimuth, "only isotropic scattering does without it")
    angle = as_float_array("azimuth", 0.0 if azimuth is None else azimuth)
    require("azimuth", angle, np.isfinite(angle), "must be finite [rad]")
    return angle
