"""Samplers, pure functions of uniforms, and Monte Carlo estimators of the rendering equation. Nothing shared with the oracle."""

from fogproof.estimators.compiled import CompiledField
from fogproof.estimators.delta_tracking import DeltaFreePath, DeltaTransmittance, delta_tracking
from fogproof.estimators.equiangular import Equiangular
from fogproof.estimators.fog import AnalogFog
from fogproof.estimators.free_path import HomogeneousFreePath
from fogproof.estimators.henyey_greenstein import HenyeyGreensteinDirections
from fogproof.estimators.isotropic import IsotropicDirections
from fogproof.estimators.majorant_grid import MajorantGrid
from fogproof.estimators.noise import FractalNoise
from fogproof.estimators.phase import direction_sampler, phase_value
from fogproof.estimators.ratio_tracking import RatioTransmittance, ResidualRatioTransmittance, ratio_tracking
from fogproof.estimators.ray_marching import MarchedFreePath, MarchedTransmittance, RayMarch, feature_size
from fogproof.estimators.rayleigh import RayleighDirections
from fogproof.estimators.regular_tracking import RegularFreePath, RegularTransmittance, regular_tracking
from fogproof.estimators.single_scattering import EquiangularAirlight, FreePathAirlight
from fogproof.estimators.spectral_tracking import SpectralFog, SpectralFreePath, spectral_tracking
from fogproof.estimators.transmittance import AnalogTransmittance

__all__ = [
    "AnalogFog",
    "AnalogTransmittance",
    "CompiledField",
    "DeltaFreePath",
    "DeltaTransmittance",
    "Equiangular",
    "EquiangularAirlight",
    "FractalNoise",
    "FreePathAirlight",
    "HenyeyGreensteinDirections",
    "HomogeneousFreePath",
    "IsotropicDirections",
    "MajorantGrid",
    "MarchedFreePath",
    "MarchedTransmittance",
    "RatioTransmittance",
    "RayMarch",
    "RayleighDirections",
    "RegularFreePath",
    "RegularTransmittance",
    "ResidualRatioTransmittance",
    "SpectralFog",
    "SpectralFreePath",
    "delta_tracking",
    "direction_sampler",
    "feature_size",
    "phase_value",
    "ratio_tracking",
    "regular_tracking",
    "spectral_tracking",
]
