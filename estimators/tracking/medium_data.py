"""What trackers see of a medium: data for kernels, an array function of points, where it ends, and how strong it can be."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators.kernels import data as kinds
from fogproof.estimators.tracking.compiled import CompiledField, is_compiled
from fogproof.estimators.tracking.noise import FractalNoise
from fogproof.scene import (
    AnyMedium,
    ExponentialMedium,
    LinearMedium,
    Medium,
    PiecewiseConstantMedium,
    Procedural,
    VoxelGrid,
)

Field = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Points (k, 3) and directions (k, 3) -> extinction (k, channels) [1/m]."""


def medium_data(medium: AnyMedium) -> Any:
    """Return a medium as data for kernels, None if it is an array function."""
    match medium:
        case Medium():
            sigma = np.array(np.atleast_1d(medium.sigma_t))
            return kinds.LinearData(sigma, np.zeros((len(sigma), 3)))
        case LinearMedium():
            return kinds.LinearData(*_rows(medium.sigma_0, medium.gradient, medium.channels))
        case ExponentialMedium():
            return kinds.ExponentialData(*_rows(medium.sigma_0, medium.rate, medium.channels))
        case PiecewiseConstantMedium():
            sigma = np.array(medium.sigma_t.reshape(len(medium.sigma_t), -1))
            return kinds.LayerData(sigma, np.array(medium.boundaries), np.array(medium.axis))
        case VoxelGrid():
            kind = kinds.NearestData if medium.interpolation == "nearest" else kinds.TrilinearData
            shape = medium.sigma_t.shape[:3]
            per_metre = np.array(shape) / (medium.upper - medium.lower)
            return kind(medium.sigma_t.reshape(*shape, -1), np.array(medium.lower), per_metre)
        case Procedural(sigma_t=FractalNoise() as noise):
            return kinds.NoiseData(noise.density, noise.frequency, noise.octaves, noise.gain, noise.table)
        case Procedural(sigma_t=CompiledField() as field):
            return (kinds.FieldData if field.channels is None else kinds.ChromaticFieldData)(field.function)
        case Procedural(sigma_t=function) if is_compiled(function):
            raise InvalidValueError(
                "sigma_t", "must be an array function", function, "wrap it: CompiledField(function)"
            )
        case Procedural():
            return None
    known = "homogeneous, linear, exponential, layered, voxel and procedural media"
    raise UnsupportedError(f"trackers know {known}, got {type(medium).__name__}", "medium")


def look_ups(medium: AnyMedium) -> Field:
    """Return the extinction [1/m] as a function of points and directions (k, 3), (k, channels)."""
    if isinstance(medium, Procedural):
        procedural = medium

        def field(x: np.ndarray, w: np.ndarray) -> np.ndarray:
            value = procedural.sigma_t(x, w) if procedural.directional else procedural.sigma_t(x)
            shape = (len(x),) if procedural.channels is None else (len(x), procedural.channels)
            if np.shape(value) != shape:
                raise InvalidValueError(
                    "sigma_t", f"must return an array of shape {list(shape)}", list(np.shape(value))
                )
            return np.asarray(value, dtype=np.float64).reshape(len(x), -1)

        return field
    data, channels = medium_data(medium), medium.channels or 1

    def points(x: np.ndarray, w: np.ndarray) -> np.ndarray:
        from fogproof.estimators.kernels.tracking import look_up

        sigma = np.empty((len(x), channels))
        look_up(data, np.ascontiguousarray(x), sigma)
        return sigma

    return points


def box(medium: AnyMedium) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of what the medium fills, infinite if it has no end."""
    if isinstance(medium, (VoxelGrid, Procedural)):
        return np.array(medium.lower), np.array(medium.upper)
    return np.full(3, -np.inf), np.full(3, np.inf)


def grey_medium(medium: AnyMedium) -> AnyMedium:
    """Return a grey medium, or say that the estimator has no channels."""
    if medium.channels is not None:
        raise UnsupportedError(
            f"the medium has {medium.channels} channels; this estimator follows one: see SpectralFreePath", "medium"
        )
    return medium


def extremes(
    medium: AnyMedium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return bounds of the extinction along each ray over all channels, (rays,) each."""
    if np.isinf(length).any() and not np.isfinite(box(medium)).all():
        name = type(medium).__name__
        raise UnsupportedError(
            f"a tracker would never end on an infinite ray through a {name}: give the ray a length", "ray"
        )
    low, high = 0.0, 0.0
    match medium:
        case LinearMedium() | ExponentialMedium():
            field, ends = look_ups(medium), (origin, origin + length[:, None] * direction)
            sigma = np.concatenate([field(end, direction) for end in ends], axis=-1)
            return sigma.min(axis=-1), sigma.max(axis=-1)
        case Medium():
            low, high = float(np.min(medium.sigma_t)), float(np.max(medium.sigma_t))
        case VoxelGrid():
            low, high = float(medium.sigma_t.min()), float(medium.sigma_t.max())
        case PiecewiseConstantMedium():
            high = float(medium.sigma_t.max())
        case Procedural():
            high = medium.majorant
    return np.full(length.shape, low), np.full(length.shape, high)


def _rows(value: Any, vectors: np.ndarray, channels: int | None) -> tuple[np.ndarray, np.ndarray]:
    shape = channels or 1
    return np.array(np.broadcast_to(value, shape)), np.array(np.broadcast_to(vectors, (shape, 3)))
