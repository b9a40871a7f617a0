"""Equiangular sampling of a ray around a light (Kulla & Fajardo 2012): uniform in the angle the light sees."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import HalfLine, Interval
from fogproof.errors import InvalidValueError
from fogproof.validate import number


@dataclass(frozen=True)
class Equiangular:
    """Positions t on a ray, measured from the foot of the perpendicular from the light.

    h     distance of the light from the ray's line [m], > 0
    a, b  ends of the segment [m]; b may be inf

    The density is h / (Theta (h^2 + t^2)) [1/m], Theta the angle the segment subtends at the light.
    """

    h: float
    a: float
    b: float
    dimensions: ClassVar[int] = 1

    def __post_init__(self) -> None:
        number(
            "h", self.h, "must be finite and > 0 [m]", 0, open_ends=True, fix="a light on the ray needs another sampler"
        )
        number("a", self.a, "must be finite [m]")
        if not self.b > self.a:
            raise InvalidValueError("b", f"must be greater than a = {self.a:g} [m]", self.b)

    @property
    def domain(self) -> Interval | HalfLine:
        """[a, b], or [a, inf)."""
        return HalfLine(self.a) if np.isinf(self.b) else Interval(self.a, self.b)

    @property
    def angle(self) -> float:
        """Theta: one arctangent of the ends together, because the difference of two cancels when the light is far away."""
        if np.isinf(self.b):
            return float(np.arctan2(self.h, self.a))
        return float(np.arctan2(self.h * (self.b - self.a), self.h * self.h + self.a * self.b))

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to positions [m] and their density [1/m]."""
        tangent = np.tan(u[:, 0] * self.angle)
        with np.errstate(divide="ignore"):
            t = self.h * (self.a + self.h * tangent) / (self.h - self.a * tangent)
        t = np.clip(t, self.a, min(self.b, np.finfo(t.dtype).max))
        return Draw(t, self.pdf(t))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density at positions x (n,) [1/m]."""
        return self.h / (self.angle * (self.h * self.h + x * x))
