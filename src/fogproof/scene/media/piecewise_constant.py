"""A medium of plane layers."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.media.common import cell_channels, cells_of_channel, cells_vary, read_only, set_cells
from fogproof.scene.phase import AnyPhaseField, Isotropic, require_any_phase
from fogproof.validate import as_float_array, require, unit_vectors


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
    def is_empty(self) -> bool:
        """Whether there is vacuum everywhere."""
        return not np.any(self.sigma_t)

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return cell_channels(self, 1)

    @property
    def sources_vary(self) -> bool:
        """Whether albedo or emission differ from layer to layer."""
        return cells_vary(self)

    def channel(self, c: int) -> PiecewiseConstantMedium:
        """Return the grey medium that channel c sees."""
        grey: PiecewiseConstantMedium = cells_of_channel(self, 1, c)
        return grey
