"""The environment as an image."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import FloatArray
from fogproof.validate import Channels, as_float_array, nonnegative_channels, require

MOST_PIXELS = 1 << 24


@dataclass(frozen=True, eq=False)
class EnvironmentMap:
    """Radiance from infinitely far as a picture of all directions, constant in each pixel, from outside of what holds the medium.

    image     (rows, columns) >= 0, what the radiance is multiplied with. The first row looks to +z and the last to -z, rows being
              equal steps of the polar angle; columns are equal steps of the azimuth from +x over +y
    radiance  [W/(m^2 sr)], grey or one value a channel
    """

    image: FloatArray
    radiance: Channels = 1.0
    strength_field: ClassVar[str] = "radiance"
    distant: ClassVar[bool] = True
    delta: ClassVar[bool] = False

    def __post_init__(self) -> None:
        image = as_float_array("image", self.image)
        if image.ndim != 2 or not 1 <= image.size <= MOST_PIXELS:
            fix = "a picture in colour is one light a channel" if image.ndim == 3 else ""
            raise InvalidValueError("image", "must be a grey picture (rows, columns)", list(image.shape), fix)
        require("image", image, np.isfinite(image) & (image >= 0), "must be finite and >= 0")
        image = image.copy()
        image.flags.writeable = False
        object.__setattr__(self, "image", image)
        object.__setattr__(self, "radiance", nonnegative_channels("radiance", self.radiance, "W/(m^2 sr)"))
