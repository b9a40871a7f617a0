"""Samplers, pure functions of uniforms, and Monte Carlo estimators of the rendering equation. Nothing shared with the oracle."""

from fogproof.estimators.directions import Cosines, Directions
from fogproof.estimators.equiangular import Equiangular
from fogproof.estimators.extinction import Constant, Exponential, Linear, Vanishing, along
from fogproof.estimators.fog import AnalogFog, CertainCollisionFog, SpectralFog, UniformEmission
from fogproof.estimators.free_path import FreePath, SpectralFreePath, TruncatedFreePath
from fogproof.estimators.phase import phase_table, phase_value
from fogproof.estimators.single_scattering import EquiangularAirlight, FreePathAirlight
from fogproof.estimators.transmittance import AnalogTransmittance, SpectralTransmittance

__all__ = [
    "AnalogFog",
    "AnalogTransmittance",
    "CertainCollisionFog",
    "Constant",
    "Cosines",
    "Directions",
    "Equiangular",
    "EquiangularAirlight",
    "Exponential",
    "FreePath",
    "FreePathAirlight",
    "Linear",
    "SpectralFog",
    "SpectralFreePath",
    "SpectralTransmittance",
    "TruncatedFreePath",
    "UniformEmission",
    "Vanishing",
    "along",
    "phase_table",
    "phase_value",
]
