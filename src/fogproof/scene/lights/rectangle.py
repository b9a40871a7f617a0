"""The rectangle that shines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.validate import Channels, nonnegative_channels, one_point


@dataclass(frozen=True)
class RectangleLight:
    """A flat rectangle that shines from one side, the same in all directions. It is opaque: a ray ends at it.

    corner          (x, y, z) [m]
    edge_u, edge_v  vectors along its sides from there, at a right angle [m]; it shines on the side of edge_u x edge_v
    radiance        [W/(m^2 sr)], grey or one value a channel
    """

    corner: tuple[float, float, float]
    edge_u: tuple[float, float, float]
    edge_v: tuple[float, float, float]
    radiance: Channels
    strength_field: ClassVar[str] = "radiance"
    distant: ClassVar[bool] = False
    delta: ClassVar[bool] = False

    def __post_init__(self) -> None:
        for name in ("corner", "edge_u", "edge_v"):
            object.__setattr__(self, name, one_point(name, getattr(self, name)))
        u, v = np.array(self.edge_u), np.array(self.edge_v)
        for name, length in (("edge_u", np.linalg.norm(u)), ("edge_v", np.linalg.norm(v))):
            if not length > 0:
                raise InvalidValueError(name, "must have a length > 0 [m]", getattr(self, name))
        if not abs(u @ v) <= 1e-9 * np.linalg.norm(u) * np.linalg.norm(v):
            raise InvalidValueError("edge_v", f"must be at a right angle to edge_u = {self.edge_u}", self.edge_v)
        object.__setattr__(self, "radiance", nonnegative_channels("radiance", self.radiance, "W/(m^2 sr)"))
