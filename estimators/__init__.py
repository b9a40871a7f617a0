"""Samplers, pure functions of uniforms, and Monte Carlo estimators of the rendering equation. Nothing shared with the oracle."""

from fogproof.estimators.directions import Cosines, Directions
from fogproof.estimators.environment_airlight import EnvironmentAirlight
from fogproof.estimators.equiangular import Equiangular
from fogproof.estimators.extinction import Constant, Exponential, Linear, Vanishing, along
from fogproof.estimators.fog import AnalogFog, CertainCollisionFog, SpectralFog, UniformEmission
from fogproof.estimators.free_path import FreePath, SpectralFreePath, TruncatedFreePath
from fogproof.estimators.lit_medium import LitMedium
from fogproof.estimators.marched_airlight import MarchedAirlight
from fogproof.estimators.phase import phase_table, phase_value
from fogproof.estimators.placing import placer
from fogproof.estimators.single_scattering import Airlight
from fogproof.estimators.transmittance import AnalogTransmittance, SpectralTransmittance

__all__ = [
    "Airlight",
    "AnalogFog",
    "AnalogTransmittance",
    "CertainCollisionFog",
    "Constant",
    "Cosines",
    "Directions",
    "EnvironmentAirlight",
    "Equiangular",
    "Exponential",
    "FreePath",
    "Linear",
    "LitMedium",
    "MarchedAirlight",
    "SpectralFog",
    "SpectralFreePath",
    "SpectralTransmittance",
    "TruncatedFreePath",
    "UniformEmission",
    "Vanishing",
    "along",
    "phase_table",
    "phase_value",
    "placer",
]
