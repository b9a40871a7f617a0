"""A medium that is a sum of Gaussian puffs, as smoke is simulated and clouds are fitted."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.media.common import channels_with, read_only, set_common
from fogproof.scene.phase import AnyPhaseField, Isotropic
from fogproof.validate import Channels, as_float_array, require


@dataclass(frozen=True, eq=False)
class GaussianPuffs:
    """Extinction sigma_t(x) = sum of density exp(-|x - centre|^2 / (2 width^2)) over n puffs.

    centers   (n, 3) [m]
    widths    (n,), or a number for all: standard deviation of each puff [m], > 0
    densities (n,), or a number for all: extinction at its centre if it were alone [1/m], >= 0
    albedo    sigma_s / sigma_t in [0, 1], the same everywhere
    phase     phase function
    emission  emitted radiance L_e [W/(m^2 sr)]; the rendering equation multiplies it by sigma_a
    """

    centers: FloatArray
    widths: FloatArray
    densities: FloatArray
    albedo: Channels = 0.0
    phase: AnyPhaseField = field(default_factory=Isotropic)
    emission: Channels = 0.0

    def __post_init__(self) -> None:
        centers = as_float_array("centers", self.centers)
        if centers.ndim != 2 or centers.shape[1] != 3 or not len(centers):
            raise InvalidValueError("centers", "must be a list of at least one point [x, y, z]", list(centers.shape))
        require("centers", centers, np.isfinite(centers), "must be finite [m]")
        object.__setattr__(self, "centers", read_only(centers))
        for name, rule in (("widths", "must be finite and > 0 [m]"), ("densities", "must be finite and >= 0 [1/m]")):
            array = as_float_array(name, getattr(self, name))
            if array.shape not in ((), (len(centers),)):
                raise InvalidValueError(name, f"must be a number or one a puff, {len(centers)}", list(array.shape))
            good = (array > 0) if name == "widths" else (array >= 0)
            require(name, array, np.isfinite(array) & good, rule)
            object.__setattr__(self, name, read_only(np.broadcast_to(array, len(centers))))
        set_common(self)

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return channels_with(self)

    @property
    def is_empty(self) -> bool:
        """Whether there is vacuum everywhere."""
        return not np.any(self.densities)
