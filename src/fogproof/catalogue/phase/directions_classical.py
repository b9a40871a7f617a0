"""Isotropic and Rayleigh directions against the oracle."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue.cases import Case
from fogproof.catalogue.phase.directions import (
    TILTED,
    about_z,
    case_of_directions,
    sampled_from,
    unrotated,
)
from fogproof.estimators import Directions
from fogproof.scene import (
    Isotropic,
    Rayleigh,
)


def _uniform_in_angle(sampler: Directions, u: np.ndarray) -> np.ndarray:
    return about_z(np.cos(np.pi * u[:, 0]), u[:, 1])


def cases() -> list[Case]:
    """Return the cases of the two oldest phase functions."""
    local = "the local direction is returned without rotation"
    return [
        case_of_directions(
            name="isotropic",
            title="Isotropic directions",
            phase=Isotropic(),
            source="Archimedes",
            error="uniform in the angle theta, not in its cosine",
            sample=_uniform_in_angle,
        ),
        case_of_directions(
            name="rayleigh",
            title="Rayleigh directions",
            phase=Rayleigh(),
            source="Rayleigh 1871",
            error="isotropic sampling under the Rayleigh density",
            sample=sampled_from(Isotropic()),
        ),
        case_of_directions(
            name="rayleigh/tilted",
            title="Rayleigh directions",
            phase=Rayleigh(),
            source="Rayleigh 1871",
            error=local,
            sample=unrotated,
            axis=TILTED,
        ),
    ]
