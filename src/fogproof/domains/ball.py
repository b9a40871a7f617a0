"""The solid ball in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.domains.law import Law, at_the_ends, squared
from fogproof.domains.sphere import TURN, azimuth, direction, versine
from fogproof.errors import InvalidValueError
from fogproof.validate import coordinates, number


@dataclass(frozen=True)
class Ball:
    """The points of space within `radius` of `center`; the pdf is per unit volume."""

    radius: float = 1.0
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)

    shape = (3,)

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", number("radius", self.radius, "must be > 0", 0, open_ends=True))
        center = coordinates("center", self.center)
        if len(center) != 3 or not np.isfinite(center).all():
            raise InvalidValueError("center", "must be three finite numbers", self.center)
        object.__setattr__(self, "center", center)

    @property
    def measure(self) -> float:
        """The volume."""
        return 2 / 3 * TURN * self.radius**3

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which points are no farther from the centre than the radius."""
        scale = self.radius + float(np.max(np.abs(self.center)))
        room = max(4 * slack * scale, 2 * at_the_ends(slack) * self.radius)
        return squared(x - np.array(self.center)) <= self.radius**2 + room * self.radius

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law."""
        return Law(("r^3", "mu", "phi"), self._place, self._coordinates, lambda x: np.full(len(x), 1 / self.measure))

    def _place(self, u: np.ndarray) -> np.ndarray:
        r = self.radius * np.cbrt(u[:, :1])
        return np.array(self.center) + r * direction(2 * u[:, 1], u[:, 2])

    def _coordinates(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        d = x - np.array(self.center)
        r = np.sqrt(squared(d))
        unit = d / np.where(r > 0, r, 1.0)[:, None]
        cube = np.minimum((r / self.radius) ** 3, 1.0)
        return np.stack([cube, np.clip(0.5 * versine(unit), 0, 1), azimuth(d[:, 0], d[:, 1])], axis=-1)
