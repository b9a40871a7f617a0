"""Samplers, pure functions of uniforms, and Monte Carlo estimators of the rendering equation. Nothing shared with the oracle."""

from fogproof.estimators.compiled import CompiledField
from fogproof.estimators.decoupled_airlight import CachedTransmittance, DecoupledAirlight
from fogproof.estimators.delta_tracking import DeltaFreePath, DeltaTransmittance, delta_tracking
from fogproof.estimators.directions import Cosines, Directions
from fogproof.estimators.environment_airlight import EnvironmentAirlight
from fogproof.estimators.equiangular import Equiangular
from fogproof.estimators.extinction import Constant, Exponential, Linear, Vanishing, along
from fogproof.estimators.fog import AnalogFog, CertainCollisionFog, HomogeneousSpectralFog, UniformEmission
from fogproof.estimators.free_path import FreePath, HomogeneousSpectralFreePath, TruncatedFreePath
from fogproof.estimators.lit_medium import LitMedium
from fogproof.estimators.majorant_grid import MajorantGrid
from fogproof.estimators.marched_airlight import MarchedAirlight
from fogproof.estimators.noise import FractalNoise
from fogproof.estimators.path_tracing import PathTracer, Roulette
from fogproof.estimators.phase import phase_table, phase_value
from fogproof.estimators.placing import placer
from fogproof.estimators.random_walks import PointSourceWalks, RandomFlights, RodWalks, ScatteringsUnderUniformSky
from fogproof.estimators.ratio_tracking import RatioTransmittance, ResidualRatioTransmittance, ratio_tracking
from fogproof.estimators.ray_marching import MarchedFreePath, MarchedTransmittance, RayMarch, feature_size
from fogproof.estimators.regular_tracking import RegularFreePath, RegularTransmittance, regular_tracking
from fogproof.estimators.shadow_rays import shadow_transmittance
from fogproof.estimators.single_scattering import Airlight
from fogproof.estimators.spectral_path_tracing import SpectralPathTracer
from fogproof.estimators.spectral_tracking import SpectralFog, SpectralFreePath, spectral_tracking
from fogproof.estimators.transmittance import AnalogTransmittance, SpectralTransmittance

__all__ = [
    "Airlight",
    "AnalogFog",
    "AnalogTransmittance",
    "CachedTransmittance",
    "CertainCollisionFog",
    "CompiledField",
    "Constant",
    "Cosines",
    "DecoupledAirlight",
    "DeltaFreePath",
    "DeltaTransmittance",
    "Directions",
    "EnvironmentAirlight",
    "Equiangular",
    "Exponential",
    "FractalNoise",
    "FreePath",
    "HomogeneousSpectralFog",
    "HomogeneousSpectralFreePath",
    "Linear",
    "LitMedium",
    "MajorantGrid",
    "MarchedAirlight",
    "MarchedFreePath",
    "MarchedTransmittance",
    "PathTracer",
    "PointSourceWalks",
    "RandomFlights",
    "RatioTransmittance",
    "RayMarch",
    "RegularFreePath",
    "RegularTransmittance",
    "ResidualRatioTransmittance",
    "RodWalks",
    "Roulette",
    "ScatteringsUnderUniformSky",
    "SpectralFog",
    "SpectralFreePath",
    "SpectralPathTracer",
    "SpectralTransmittance",
    "TruncatedFreePath",
    "UniformEmission",
    "Vanishing",
    "along",
    "delta_tracking",
    "feature_size",
    "phase_table",
    "phase_value",
    "placer",
    "ratio_tracking",
    "regular_tracking",
    "shadow_transmittance",
    "spectral_tracking",
]
