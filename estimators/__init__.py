"""Samplers, pure functions of uniforms, and Monte Carlo estimators of the rendering equation. Nothing shared with the oracle."""

from fogproof.estimators.directions import Cosines, Directions
from fogproof.estimators.equiangular import Equiangular
from fogproof.estimators.fog import AnalogFog
from fogproof.estimators.free_path import HomogeneousFreePath
from fogproof.estimators.phase import phase_table, phase_value
from fogproof.estimators.single_scattering import EquiangularAirlight, FreePathAirlight
from fogproof.estimators.transmittance import AnalogTransmittance

__all__ = [
    "AnalogFog",
    "AnalogTransmittance",
    "Cosines",
    "Directions",
    "Equiangular",
    "EquiangularAirlight",
    "FreePathAirlight",
    "HomogeneousFreePath",
    "phase_table",
    "phase_value",
]
