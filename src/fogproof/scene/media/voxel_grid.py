"""A medium on a grid of voxels, as simulations and scans deliver it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.media.common import cell_channels, cells_of_channel, cells_vary, set_cells
from fogproof.scene.phase import AnyPhaseField, Isotropic, require_any_phase
from fogproof.validate import as_float_array, points, require

Interpolation = Literal["nearest", "trilinear"]


@dataclass(frozen=True, eq=False)
class VoxelGrid:
    """A box of nx x ny x nz equal voxels, with vacuum outside.

    sigma_t        (nx, ny, nz), or (nx, ny, nz, channels): extinction coefficient [1/m], >= 0
    lower, upper   (3,) corners of the box [m]
    interpolation  "nearest": each value fills its voxel, which is closed below and open above; "trilinear": the
                   values stand at the centres of the voxels, and the half voxel at the border repeats the outermost
    albedo         sigma_s / sigma_t in [0, 1]: a number, or in the shape of sigma_t and interpolated likewise
    phase          phase function
    emission       emitted radiance L_e [W/(m^2 sr)]: a number, or in the shape of sigma_t and interpolated likewise;
                   the rendering equation multiplies it by sigma_a
    """

    sigma_t: FloatArray
    lower: FloatArray
    upper: FloatArray
    interpolation: Interpolation = "trilinear"
    albedo: FloatArray = 0.0
    phase: AnyPhaseField = field(default_factory=Isotropic)
    emission: FloatArray = 0.0

    def __post_init__(self) -> None:
        sigma_t = as_float_array("sigma_t", self.sigma_t)
        if sigma_t.ndim not in (3, 4) or sigma_t.size == 0:
            rule = "must be a grid (nx, ny, nz) or (nx, ny, nz, channels) with at least one voxel"
            raise InvalidValueError("sigma_t", rule, list(sigma_t.shape))
        for name in ("lower", "upper"):
            corner = points(name, getattr(self, name))
            if corner.ndim != 1:
                raise InvalidValueError(name, "must be one corner [x, y, z]", getattr(self, name))
            object.__setattr__(self, name, corner)
        require(
            "upper", self.upper, self.upper > self.lower, f"must be above lower = {self.lower.tolist()} on each axis"
        )
        if self.interpolation not in get_args(Interpolation):
            raise InvalidValueError("interpolation", "must be 'nearest' or 'trilinear'", self.interpolation)
        set_cells(self, sigma_t.shape[:3], "one value a voxel")
        require_any_phase("phase", self.phase)

    @property
    def is_empty(self) -> bool:
        """Whether there is vacuum everywhere."""
        return not np.any(self.sigma_t)

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return cell_channels(self, 3)

    @property
    def sources_vary(self) -> bool:
        """Whether albedo or emission differ from voxel to voxel."""
        return cells_vary(self)

    def channel(self, c: int) -> VoxelGrid:
        """Return the grey medium that channel c sees."""
        grey: VoxelGrid = cells_of_channel(self, 3, c)
        return grey
