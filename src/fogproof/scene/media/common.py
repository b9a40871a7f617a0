"""Fields that kinds of media have in common: how they are cleaned, and how one channel of them is taken."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.phase import require_any_phase
from fogproof.validate import Channels, as_float_array, channel_count, nonnegative_channels, require


def read_only(array: np.ndarray) -> np.ndarray:
    """Return a copy that nobody can change."""
    array = array.copy()
    array.flags.writeable = False
    return array


def albedo_channels(value: Any) -> Channels:
    """Return an albedo in [0, 1], or a tuple of them with one a channel."""
    albedo = nonnegative_channels("albedo", value, "dimensionless")
    require("albedo", np.asarray(albedo), np.asarray(albedo) <= 1, "must lie in [0, 1]")
    return albedo


def set_cells(medium: Any, shape: tuple[int, ...], fix: str) -> None:
    """Clean sigma_t, albedo and emission of a medium made of cells in an array of that shape, channels last."""
    rules = {"sigma_t": (np.inf, "[1/m]"), "albedo": (1.0, "and <= 1"), "emission": (np.inf, "[W/(m^2 sr)]")}
    for name, (high, unit) in rules.items():
        array = as_float_array(name, getattr(medium, name))
        constant = array.ndim == 0 and name != "sigma_t"
        if not constant and (array.shape[: len(shape)] != shape or array.ndim > len(shape) + 1 or array.size == 0):
            raise InvalidValueError(name, f"must have the shape {list(shape)}, channels last", list(array.shape), fix)
        require(name, array, np.isfinite(array) & (array >= 0) & (array <= high), f"must be finite, >= 0 {unit}")
        object.__setattr__(medium, name, read_only(array))
    cell_channels(medium, len(shape))


def cell_channels(medium: Any, axes: int) -> int | None:
    """Return the channels of a medium made of cells in an array with that many axes."""
    arrays = {name: getattr(medium, name) for name in ("sigma_t", "albedo", "emission")}
    return channel_count(
        **{name: (0.0,) * array.shape[-1] if array.ndim > axes else 0.0 for name, array in arrays.items()}
    )


def set_vectors(medium: Any, name: str, unit: str) -> None:
    """Clean a field of vectors (3,), or (channels, 3) with one a channel."""
    array = as_float_array(name, getattr(medium, name))
    if array.ndim not in (1, 2) or array.shape[-1] != 3 or array.size == 0:
        raise InvalidValueError(name, "must be one vector [x, y, z], or one a channel", list(array.shape))
    require(name, array, np.isfinite(array), f"must be finite [{unit}]")
    object.__setattr__(medium, name, read_only(array))


def row(vectors: np.ndarray) -> Channels:
    """Return something that counts as many channels as there are vectors."""
    return 0.0 if vectors.ndim == 1 else (0.0,) * len(vectors)


def set_common(medium: Any) -> None:
    """Clean albedo, emission and phase function of a medium in which they are the same everywhere."""
    object.__setattr__(medium, "albedo", albedo_channels(medium.albedo))
    object.__setattr__(medium, "emission", nonnegative_channels("emission", medium.emission, "W/(m^2 sr)"))
    require_any_phase("phase", medium.phase)
    _ = medium.channels


def channels_with(medium: Any, **own: Channels) -> int | None:
    """Return the channels of albedo, emission and the named values together; None if all are grey."""
    return channel_count(albedo=medium.albedo, emission=medium.emission, **own)


def channel_of(value: Any, c: int) -> Any:
    """Return channel c of a value that may be grey."""
    return value[c] if isinstance(value, tuple) else value


def vector_of(vectors: np.ndarray, c: int) -> np.ndarray:
    """Return the vector of channel c, (3,), of one or of one a channel."""
    return vectors[c] if vectors.ndim == 2 else vectors


def cells_of_channel(medium: Any, axes: int, c: int) -> Any:
    """Return the grey medium that channel c of a medium made of cells sees."""
    values = {name: getattr(medium, name) for name in ("sigma_t", "albedo", "emission")}
    return replace(medium, **{name: v[..., c] if np.ndim(v) > axes else v for name, v in values.items()})


def cells_vary(medium: Any) -> bool:
    """Return whether albedo or emission differ from cell to cell."""
    return bool(medium.albedo.ndim + medium.emission.ndim > 0)
