"""A hot medium on a grid of voxels, as fire is simulated: it glows as a black body does."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.media.common import channel_of, read_only
from fogproof.scene.media.voxel_grid import VoxelGrid
from fogproof.validate import Channels, as_float_array, channel_count, nonnegative_channels, require


@dataclass(frozen=True, eq=False)
class TemperatureGrid:
    """A voxel grid whose L_e is the spectral radiance of a black body of its temperature [W/(m^2 sr nm)].

    grid         extinction, albedo and phase function; its own emission must be 0
    temperature  (nx, ny, nz) [K], >= 0, interpolated as the extinction is, and Planck's law then
    wavelengths  one number, or one a channel [m], > 0
    """

    grid: VoxelGrid
    temperature: FloatArray
    wavelengths: Channels

    def __post_init__(self) -> None:
        if not isinstance(self.grid, VoxelGrid):  # validates its own field
            raise InvalidValueError("grid", "must be a VoxelGrid", self.grid)
        if np.any(self.grid.emission):
            fix = "the temperature says what glows"
            raise InvalidValueError("grid.emission", "must be 0", float(np.max(self.grid.emission)), fix)
        temperature, shape = as_float_array("temperature", self.temperature), self.grid.sigma_t.shape[:3]
        if temperature.shape != shape:
            raise InvalidValueError("temperature", f"must have the shape {list(shape)}", list(temperature.shape))
        require(
            "temperature", temperature, np.isfinite(temperature) & (temperature >= 0), "must be finite and >= 0 [K]"
        )
        object.__setattr__(self, "temperature", read_only(temperature))
        wavelengths = nonnegative_channels("wavelengths", self.wavelengths, "m")
        require("wavelengths", np.asarray(wavelengths), np.asarray(wavelengths) > 0, "must be > 0 [m]")
        object.__setattr__(self, "wavelengths", wavelengths)
        _ = self.channels

    @property
    def lower(self) -> np.ndarray:
        """Corner of the box [m]."""
        return np.asarray(self.grid.lower)

    @property
    def upper(self) -> np.ndarray:
        """The opposite corner [m]."""
        return np.asarray(self.grid.upper)

    @property
    def albedo(self) -> Any:
        """That of the grid."""
        return self.grid.albedo

    @property
    def phase(self) -> Any:
        """That of the grid."""
        return self.grid.phase

    @property
    def emission(self) -> Any:
        """Above 0 where the medium glows; how much follows from Planck's law."""
        return self.temperature

    @property
    def is_empty(self) -> bool:
        """Whether there is vacuum everywhere."""
        return self.grid.is_empty

    @property
    def sources_vary(self) -> bool:
        """They do."""
        return True

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return channel_count(
            grid=(0.0,) * self.grid.channels if self.grid.channels else 0.0, wavelengths=self.wavelengths
        )

    def channel(self, c: int) -> TemperatureGrid:
        """Return the grey medium that channel c sees."""
        grid = self.grid if self.grid.channels is None else self.grid.channel(c)
        return replace(self, grid=grid, wavelengths=channel_of(self.wavelengths, c))
