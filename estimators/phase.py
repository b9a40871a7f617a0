"""From a scene's phase function to its value and its direction sampler."""

from __future__ import annotations

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators import henyey_greenstein, isotropic, rayleigh
from fogproof.estimators.frames import Axis
from fogproof.estimators.henyey_greenstein import HenyeyGreensteinDirections
from fogproof.estimators.isotropic import IsotropicDirections
from fogproof.estimators.rayleigh import RayleighDirections
from fogproof.scene import HenyeyGreenstein, Isotropic, PhaseFunction, Rayleigh

DirectionSampler = IsotropicDirections | HenyeyGreensteinDirections | RayleighDirections


def phase_value(phase: PhaseFunction, mu: np.ndarray) -> np.ndarray:
    """Return the phase function at forward cosines mu (n,) [1/sr]."""
    match phase:
        case Isotropic():
            return isotropic.density(mu)
        case HenyeyGreenstein(g):
            return henyey_greenstein.density(g, mu)
        case Rayleigh():
            return rayleigh.density(mu)
    raise UnsupportedError(f"no estimator here evaluates {phase}")


def direction_sampler(phase: PhaseFunction, axis: Axis = (0.0, 0.0, 1.0)) -> DirectionSampler:
    """Return the sampler of scattered directions about the propagation direction `axis`."""
    match phase:
        case Isotropic():
            return IsotropicDirections(axis)
        case HenyeyGreenstein(g):
            return HenyeyGreensteinDirections(g, axis)
        case Rayleigh():
            return RayleighDirections(axis)
    raise UnsupportedError(f"no sampler here draws from {phase}")
