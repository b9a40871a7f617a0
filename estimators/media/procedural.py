"""A user's function for trackers and samplers: compiled if it is a numba function or the built-in noise."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.estimators.media.sources import looked_up
from fogproof.estimators.tracking.compiled import CompiledField, is_compiled
from fogproof.estimators.tracking.noise import FractalNoise
from fogproof.scene import Procedural, Ray
from fogproof.scene.shapes import Shape


class FieldData(NamedTuple):
    """A user's numba function of (x, y, z)."""

    function: Any

    @property
    def of_user(self) -> bool:
        """Whether kernels that call it belong to one process alone: its source is not ours."""
        return True

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        return medium.function(x, y, z)


class ChromaticFieldData(NamedTuple):
    """A user's numba function of (x, y, z, channel)."""

    function: Any

    @property
    def of_user(self) -> bool:
        """Whether kernels that call it belong to one process alone: its source is not ours."""
        return True

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        return medium.function(x, y, z, channel)


def kernel_data(medium: Procedural) -> Any:
    """Return the medium for kernels, None if it is an array function."""
    match medium.sigma_t:
        case FractalNoise() as noise:
            from fogproof.estimators.kernels.noise import NoiseData

            return NoiseData(noise.density, noise.frequency, noise.octaves, noise.gain, noise.table)
        case CompiledField() as field:
            return (FieldData if field.channels is None else ChromaticFieldData)(field.function)
        case function if is_compiled(function):
            rule = "must be an array function"
            raise InvalidValueError("sigma_t", rule, function, "wrap it: CompiledField(function)")
    return None


def extinction(medium: Procedural, x: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return what the function gives at points x along w, (k, channels) [1/m]."""
    value = medium.sigma_t(x, w) if medium.directional else medium.sigma_t(x)
    shape = (len(x),) if medium.channels is None else (len(x), medium.channels)
    if np.shape(value) != shape:
        raise InvalidValueError("sigma_t", f"must return an array of shape {list(shape)}", list(np.shape(value)))
    return np.asarray(value, dtype=np.float64).reshape(len(x), medium.channels or 1)


def bounds(medium: Procedural, origin: np.ndarray, direction: np.ndarray, length: np.ndarray) -> tuple[float, float]:
    """Return 0 and the majorant."""
    return 0.0, medium.majorant


def greatest(medium: Procedural, shape: Shape) -> float:
    """Return the majorant."""
    return medium.majorant


def feature_size(medium: Procedural, ray: Ray) -> float:
    """Return the detail that the medium declares."""
    return medium.detail


def sources(medium: Procedural, x: np.ndarray) -> tuple[Any, Any]:
    """Return albedo and emission at points x (n, 3)."""
    return looked_up(medium.albedo, x), looked_up(medium.emission, x)
