"""Samplers, pure functions of uniforms, and Monte Carlo estimators of the rendering equation. Nothing shared with the oracle."""

from fogproof.estimators.airlight.decoupled import CachedTransmittance, DecoupledAirlight
from fogproof.estimators.airlight.environment import EnvironmentAirlight
from fogproof.estimators.airlight.equiangular import Equiangular
from fogproof.estimators.airlight.lit_medium import LitMedium
from fogproof.estimators.airlight.marched import MarchedAirlight
from fogproof.estimators.airlight.placing import placer
from fogproof.estimators.airlight.shadow_rays import shadow_transmittance
from fogproof.estimators.airlight.single_scattering import Airlight
from fogproof.estimators.free_paths.extinction import Constant, Exponential, Linear, Vanishing, along
from fogproof.estimators.free_paths.fog import AnalogFog, CertainCollisionFog, HomogeneousSpectralFog, UniformEmission
from fogproof.estimators.free_paths.free_path import FreePath, HomogeneousSpectralFreePath, TruncatedFreePath
from fogproof.estimators.free_paths.transmittance import AnalogTransmittance, SpectralTransmittance
from fogproof.estimators.paths.layered_walks import LayeredWalks
from fogproof.estimators.paths.random_walks import PointSourceWalks, RandomFlights, RodWalks, ScatteringsUnderUniformSky
from fogproof.estimators.paths.spectral import SpectralPathTracer
from fogproof.estimators.paths.tracer import PathTracer, Roulette
from fogproof.estimators.phase.directions import Cosines, Directions
from fogproof.estimators.phase.functions import phase_table, phase_value
from fogproof.estimators.phase.microflakes import MicroflakeDirections
from fogproof.estimators.tracking.compiled import CompiledField
from fogproof.estimators.tracking.decomposition import DecompositionTransmittance
from fogproof.estimators.tracking.delta import DeltaFreePath, DeltaTransmittance, delta_tracking
from fogproof.estimators.tracking.jittered_marching import JitteredMarch
from fogproof.estimators.tracking.majorant_grid import MajorantGrid
from fogproof.estimators.tracking.marching import MarchedFreePath, MarchedTransmittance, RayMarch, feature_size
from fogproof.estimators.tracking.next_flight import NextFlightTransmittance
from fogproof.estimators.tracking.noise import FractalNoise
from fogproof.estimators.tracking.power_series import PowerSeriesTransmittance
from fogproof.estimators.tracking.ratio import RatioTransmittance, ResidualRatioTransmittance, ratio_tracking
from fogproof.estimators.tracking.regular import RegularFreePath, RegularTransmittance, regular_tracking
from fogproof.estimators.tracking.spectral import SpectralFog, SpectralFreePath, spectral_tracking
from fogproof.estimators.tracking.telescoping import TelescopingTransmittance
from fogproof.estimators.tracking.unbiased_marching import UnbiasedMarch
from fogproof.estimators.tracking.weighted import WeightedTransmittance

__all__ = [
    "Airlight",
    "AnalogFog",
    "AnalogTransmittance",
    "CachedTransmittance",
    "CertainCollisionFog",
    "CompiledField",
    "Constant",
    "Cosines",
    "DecompositionTransmittance",
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
    "JitteredMarch",
    "LayeredWalks",
    "Linear",
    "LitMedium",
    "MajorantGrid",
    "MarchedAirlight",
    "MarchedFreePath",
    "MarchedTransmittance",
    "MicroflakeDirections",
    "NextFlightTransmittance",
    "PathTracer",
    "PointSourceWalks",
    "PowerSeriesTransmittance",
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
    "TelescopingTransmittance",
    "TruncatedFreePath",
    "UnbiasedMarch",
    "UniformEmission",
    "Vanishing",
    "WeightedTransmittance",
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
