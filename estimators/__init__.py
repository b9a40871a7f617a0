"""Samplers, pure functions of uniforms, and Monte Carlo estimators of the rendering equation. Nothing shared with the oracle."""

from fogproof.estimators.equiangular import Equiangular
from fogproof.estimators.fog import AnalogFog
from fogproof.estimators.free_path import HomogeneousFreePath
from fogproof.estimators.henyey_greenstein import HenyeyGreensteinDirections
from fogproof.estimators.isotropic import IsotropicDirections
from fogproof.estimators.phase import direction_sampler, phase_value
from fogproof.estimators.rayleigh import RayleighDirections
from fogproof.estimators.single_scattering import EquiangularAirlight, FreePathAirlight
from fogproof.estimators.transmittance import AnalogTransmittance

__all__ = [
    "AnalogFog",
    "AnalogTransmittance",
    "Equiangular",
    "EquiangularAirlight",
    "FreePathAirlight",
    "HenyeyGreensteinDirections",
    "HomogeneousFreePath",
    "IsotropicDirections",
    "RayleighDirections",
    "direction_sampler",
    "phase_value",
]
