"""The spherical triangle: what a triangle light is, seen from a point."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from fogproof.domains.law import Law, at_the_ends
from fogproof.domains.sphere import UnitSphere, cap
from fogproof.errors import InvalidValueError

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class SphericalTriangle:
    """The directions inside the triangle of great circles between three directions a, b, c; the pdf is per steradian.

    The corners may have any length but 0. Solid angle: Van Oosterom & Strackee 1983, eq. 8.
    """

    a: Vector
    b: Vector
    c: Vector

    shape = (3,)
    vectors = ((0, 3),)

    def __post_init__(self) -> None:
        for name in ("a", "b", "c"):
            object.__setattr__(self, name, tuple(map(float, getattr(self, name))))
        corners = np.array([self.a, self.b, self.c], dtype=float)
        lengths = np.linalg.norm(corners, axis=1) if corners.shape == (3, 3) else np.zeros(1)
        if not np.all((lengths > 0) & np.isfinite(lengths)) or self._determinant == 0:
            raise InvalidValueError("c", "must be a direction off the great circle through a and b", self.c)

    @property
    def _corners(self) -> np.ndarray:
        corners = np.array([self.a, self.b, self.c], dtype=float)
        return corners / np.linalg.norm(corners, axis=1)[:, None]

    @property
    def _determinant(self) -> float:
        """Of the unit vectors; from exact rational numbers, since that of a narrow triangle is a small difference."""
        corners = np.array([self.a, self.b, self.c], dtype=float)
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = ([Fraction(x) for x in corner] for corner in corners.tolist())
        exact = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
        return float(exact / math.prod(Fraction(math.hypot(*corner)) for corner in corners.tolist()))

    @property
    def measure(self) -> float:
        """The solid angle [sr]."""
        a, b, c = self._corners
        angle = 2 * np.arctan2(abs(self._determinant), 1 + a @ b + b @ c + c @ a)
        return float(angle)

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which vectors have length 1 and lie on the inner side of all three great circles."""
        a, b, c = self._corners
        sign = np.sign(self._determinant)
        sides = [np.cross(first, second) * sign for first, second in ((a, b), (b, c), (c, a))]
        sines = [np.linalg.norm(side) for side in sides]
        lost = slack / min(sines)  # formulas that rest on the excess of the angles lose so much on a small triangle
        room = max(lost, at_the_ends(slack) * min(sines))
        inner = np.all([x @ side >= -room * sine for side, sine in zip(sides, sines, strict=True)], axis=0)
        return UnitSphere().contains(x, slack) & inner

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law on the whole sphere."""
        return cap(2.0)
