"""Equiangular sampling of a ray around a light (Kulla & Fajardo 2012): uniform in the angle the light sees."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import HalfLine, Interval
from fogproof.errors import InvalidValueError
from fogproof.estimators.blocks import IN_PLACE, blocks
from fogproof.validate import number

_FARTHEST = 1e150
"""Distance of a light whose square is still a number [m]."""


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
        if self.h > _FARTHEST:
            raise InvalidValueError(
                "h",
                f"must be at most {_FARTHEST:g} [m]: from farther away the ray is seen under no angle at all",
                self.h,
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
        """Map uniforms (n, 1) to positions [m] and their density [1/m].

        t = (a + h T)/(1 - (a/h) T), T the tangent of the angle from a to t: adding the two angles first would lose the digits of
        a short segment far from the light.
        """
        h, a, angle = self.h, self.a, self.angle
        farthest = 2 * h / (angle * float(np.finfo(u.dtype).eps))  # at the last uniform below 1 on a ray without end
        b = farthest if np.isinf(self.b) else self.b
        x, pdf = np.empty(len(u), u.dtype), np.empty(len(u), u.dtype)
        with np.errstate(divide="ignore", over="ignore"):
            for block in blocks(len(u), IN_PLACE):
                t, p = x[block], pdf[block]
                np.multiply(u[block, 0], angle, out=t)
                np.tan(t, out=t)
                np.multiply(t, -a / h, out=p)
                p += 1
                t *= h
                t += a
                t /= p
                if np.isinf(self.b):
                    np.copyto(t, b, where=(t < a) & (u[block, 0] > 0.5))  # rounding went past infinity
                np.clip(t, a, b, out=t)
                np.multiply(t, t, out=p)
                p += h * h
                np.divide(h / angle, p, out=p)
        return Draw(x, pdf)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density at positions x (n,) [1/m]."""
        return self.h / (self.angle * (self.h * self.h + x * x))
