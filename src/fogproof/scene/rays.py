"""Camera rays, one or many."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import FloatArray, PointArray
from fogproof.validate import as_float_array, points, require, unit_vectors


@dataclass(frozen=True, eq=False)
class Ray:
    """Rays through a medium: from the camera at `origin` along `direction` to the surface at distance `length`.

    origin     (..., 3) [m]
    direction  (..., 3) unit vectors, away from the camera
    length     (...) [m], >= 0: 0 where the surface is at the camera, inf where the ray meets none
    """

    origin: PointArray
    direction: PointArray
    length: FloatArray = np.inf

    def __post_init__(self) -> None:
        origin, direction = points("origin", self.origin), unit_vectors("direction", self.direction)
        length = as_float_array("length", self.length)
        require("length", length, length >= 0, "must be >= 0 [m]", "inf is allowed for a ray that meets no surface")
        try:
            shape = np.broadcast_shapes(origin.shape[:-1], direction.shape[:-1], length.shape)
        except ValueError:
            raise InvalidValueError(
                "ray",
                "must have an origin, direction and length that broadcast together",
                [origin.shape[:-1], direction.shape[:-1], length.shape],
            ) from None
        object.__setattr__(self, "origin", np.broadcast_to(origin, (*shape, 3)))
        object.__setattr__(self, "direction", np.broadcast_to(direction, (*shape, 3)))
        object.__setattr__(self, "length", np.broadcast_to(length, shape))

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the batch, () for a single ray."""
        return tuple(self.length.shape)
