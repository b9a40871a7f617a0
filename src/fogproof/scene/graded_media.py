"""Media whose extinction is graded by a formula: linear, exponential, in layers, and dependent on direction alone."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.phase import AnyPhaseField, Isotropic, require_any_phase
from fogproof.validate import Channels, as_float_array, channel_count, nonnegative_channels, require, unit_vectors


@dataclass(frozen=True, eq=False)
class LinearMedium:
    """Extinction that grows linearly: sigma_t(x) = max(0, sigma_0 + gradient . x).

    sigma_0   value at x = 0 [1/m]; it may be negative: where the sum is, there is vacuum
    gradient  (3,), or (channels, 3) with one a channel [1/m^2]
    albedo    sigma_s / sigma_t in [0, 1], the same everywhere
    phase     phase function
    emission  emitted radiance L_e [W/(m^2 sr)]; the rendering equation multiplies it by sigma_a
    """

    sigma_0: Channels
    gradient: FloatArray
    albedo: Channels = 0.0
    phase: AnyPhaseField = field(default_factory=Isotropic)
    emission: Channels = 0.0

    def __post_init__(self) -> None:
        sigma_0 = as_float_array("sigma_0", self.sigma_0)
        if sigma_0.ndim > 1 or sigma_0.size == 0:
            raise InvalidValueError("sigma_0", "must be a number or a list with one number a channel", self.sigma_0)
        require("sigma_0", sigma_0, np.isfinite(sigma_0), "must be finite [1/m]")
        object.__setattr__(self, "sigma_0", float(sigma_0) if sigma_0.ndim == 0 else tuple(sigma_0.tolist()))
        _set_vectors(self, "gradient", "1/m^2")
        _set_common(self)

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return _channels(self, sigma_0=self.sigma_0, gradient=_row(self.gradient))


@dataclass(frozen=True, eq=False)
class ExponentialMedium:
    """Extinction that grows exponentially: sigma_t(x) = sigma_0 exp(rate . x), as in an isothermal atmosphere.

    sigma_0   value at x = 0 [1/m], >= 0
    rate      (3,), or (channels, 3) with one a channel [1/m]: (0, 0, -1/H) for a scale height H along z
    albedo    sigma_s / sigma_t in [0, 1], the same everywhere
    phase     phase function
    emission  emitted radiance L_e [W/(m^2 sr)]; the rendering equation multiplies it by sigma_a
    """

    sigma_0: Channels
    rate: FloatArray
    albedo: Channels = 0.0
    phase: AnyPhaseField = field(default_factory=Isotropic)
    emission: Channels = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "sigma_0", nonnegative_channels("sigma_0", self.sigma_0, "1/m"))
        _set_vectors(self, "rate", "1/m")
        _set_common(self)

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return _channels(self, sigma_0=self.sigma_0, rate=_row(self.rate))


@dataclass(frozen=True, eq=False)
class PiecewiseConstantMedium:
    """Plane layers: layer i holds where boundaries[i] <= axis . x < boundaries[i + 1]; beyond them is vacuum.

    boundaries  (n + 1,) strictly increasing [m]; the first may be -inf, the last inf
    sigma_t     (n,), or (n, channels): extinction coefficient of each layer [1/m], >= 0
    axis        (3,) unit vector, the normal of the layers
    albedo      sigma_s / sigma_t in [0, 1]: a number, or in the shape of sigma_t
    phase       phase function
    emission    emitted radiance L_e [W/(m^2 sr)]: a number, or in the shape of sigma_t; multiplied by sigma_a
    """

    boundaries: FloatArray
    sigma_t: FloatArray
    axis: FloatArray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    albedo: FloatArray = 0.0
    phase: AnyPhaseField = field(default_factory=Isotropic)
    emission: FloatArray = 0.0

    def __post_init__(self) -> None:
        boundaries = as_float_array("boundaries", self.boundaries)
        if boundaries.ndim != 1 or boundaries.size < 2:
            raise InvalidValueError("boundaries", "must be a list of at least two positions", self.boundaries)
        require("boundaries", boundaries, ~np.isnan(boundaries), "must not be NaN")
        require("boundaries", boundaries[1:], np.diff(boundaries) > 0, "must increase")
        object.__setattr__(self, "boundaries", read_only(boundaries))
        axis = unit_vectors("axis", self.axis)
        if axis.ndim != 1:
            raise InvalidValueError("axis", "must be one vector [x, y, z]", self.axis)
        object.__setattr__(self, "axis", axis)
        set_cells(self, (boundaries.size - 1,), "one value a layer, len(boundaries) - 1 of them")
        require_any_phase("phase", self.phase)

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return cell_channels(self, 1)


@dataclass(frozen=True, eq=False)
class AnisotropicMedium:
    """Extinction that depends on the direction w alone: sigma_t(w) = sigma sqrt(w . S w), a medium of aligned flakes.

    sigma     extinction coefficient of the flakes seen face-on [1/m]
    S         (3, 3) symmetric positive semidefinite, dimensionless: the squared projected areas of a flake; the
              identity makes the medium isotropic
    albedo    sigma_s / sigma_t in [0, 1], the same for every direction
    phase     phase function
    emission  emitted radiance L_e [W/(m^2 sr)]; the rendering equation multiplies it by sigma_a

    Source: Heitz, Dupuy, Crassin & Dachsbacher 2015, The SGGX microflake distribution, eq. 10.
    """

    sigma: Channels
    S: FloatArray
    albedo: Channels = 0.0
    phase: AnyPhaseField = field(default_factory=Isotropic)
    emission: Channels = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "sigma", nonnegative_channels("sigma", self.sigma, "1/m"))
        S = as_float_array("S", self.S)
        if S.shape != (3, 3):
            raise InvalidValueError("S", "must be a 3 x 3 matrix", list(S.shape))
        require("S", S, np.isfinite(S), "must be finite")
        require("S", S, S == S.T, "must be symmetric")
        lowest = np.linalg.eigvalsh(S)[:1]
        require("S", lowest, lowest >= -1e-14 * np.abs(S).max(), "must have no negative eigenvalue")
        object.__setattr__(self, "S", read_only(S))
        _set_common(self)

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return _channels(self, sigma=self.sigma)


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


def _set_vectors(medium: Any, name: str, unit: str) -> None:
    array = as_float_array(name, getattr(medium, name))
    if array.ndim not in (1, 2) or array.shape[-1] != 3 or array.size == 0:
        raise InvalidValueError(name, "must be one vector [x, y, z], or one a channel", list(array.shape))
    require(name, array, np.isfinite(array), f"must be finite [{unit}]")
    object.__setattr__(medium, name, read_only(array))


def _row(vectors: np.ndarray) -> Channels:
    """Return something that counts as many channels as there are vectors."""
    return 0.0 if vectors.ndim == 1 else (0.0,) * len(vectors)


def _set_common(medium: Any) -> None:
    object.__setattr__(medium, "albedo", albedo_channels(medium.albedo))
    object.__setattr__(medium, "emission", nonnegative_channels("emission", medium.emission, "W/(m^2 sr)"))
    require_any_phase("phase", medium.phase)
    _ = medium.channels


def _channels(medium: Any, **own: Channels) -> int | None:
    return channel_count(albedo=medium.albedo, emission=medium.emission, **own)
