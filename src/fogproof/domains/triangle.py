"""The flat triangle, in the plane or in space."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from fogproof.domains.law import Law, at_the_ends
from fogproof.errors import InvalidValueError
from fogproof.validate import coordinates


@dataclass(frozen=True)
class _Frame:
    """A triangle on its longest side: apex and foot are measured from the side's start, `origin`.

    along, across  unit vectors of the side and of the height on it
    length, height  of the triangle; the foot of the height lies `foot` along the side
    order          which corners are the side's start, its end, and the apex
    """

    origin: np.ndarray
    along: np.ndarray
    across: np.ndarray
    length: float
    height: float
    foot: float
    order: tuple[int, int, int]


def _frame(corners: tuple[tuple[float, ...], ...]) -> _Frame:
    """Return the frame, rounded from exact rational numbers: the height of a thin triangle is a difference of long vectors."""
    exact = [[Fraction(number) for number in corner] for corner in corners]
    sides = [tuple(q - p for p, q in zip(exact[i], exact[i - 2], strict=True)) for i in range(3)]
    start = max(range(3), key=lambda i: _dot(sides[i], sides[i]))
    side, beside = sides[start], [-s for s in sides[start - 1]]
    square = _dot(side, side)
    share = _dot(side, beside) / square if square else Fraction(0)
    height = [p - share * q for p, q in zip(beside, side, strict=True)]
    length, tall = (math.hypot(*map(float, vector)) for vector in (side, height))
    along, across = (np.array(vector, dtype=float) / (size or 1.0) for vector, size in ((side, length), (height, tall)))
    order = (start, (start + 1) % 3, (start + 2) % 3)
    return _Frame(np.array(corners[start]), along, across, length, tall, float(share) * length, order)


def _dot(p: Sequence[Fraction], q: Sequence[Fraction]) -> Fraction:
    return sum((x * y for x, y in zip(p, q, strict=True)), Fraction(0))


@dataclass(frozen=True)
class Triangle:
    """The triangle with corners a, b, c of two or three numbers each; the pdf is per unit area.

    The uniform law is Turk's (1990) square-root map.
    """

    a: tuple[float, ...]
    b: tuple[float, ...]
    c: tuple[float, ...]

    def __post_init__(self) -> None:
        for name in ("a", "b", "c"):
            object.__setattr__(self, name, coordinates(name, getattr(self, name)))
        if len(self.a) not in (2, 3) or not len(self.a) == len(self.b) == len(self.c):
            raise InvalidValueError("a", "must be two or three numbers, as many as b and c", self.a)
        if not self.measure > 0:
            raise InvalidValueError("c", "must lie off the line through a and b", self.c)

    @property
    def shape(self) -> tuple[int, ...]:
        """One number an axis of the space around."""
        return (len(self.a),)

    @cached_property
    def _frame(self) -> _Frame:
        return _frame((self.a, self.b, self.c))

    @property
    def measure(self) -> float:
        """The area."""
        return 0.5 * self._frame.length * self._frame.height

    def _shares(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (n, 3) how much of a, b and c is in each point, and (n,) its distance from the triangle's plane."""
        frame = self._frame
        d = x - frame.origin
        along, across = d @ frame.along, d @ frame.across
        off = np.linalg.norm(d - along[:, None] * frame.along - across[:, None] * frame.across, axis=1)
        shares = np.empty((len(x), 3))
        start, end, apex = frame.order
        shares[:, apex] = across / frame.height
        shares[:, end] = (along - shares[:, apex] * frame.foot) / frame.length
        shares[:, start] = 1 - shares[:, apex] - shares[:, end]
        return shares, off

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which points lie in the triangle: they are rounded as the corners' coordinates are, whatever its shape."""
        shares, off = self._shares(x)
        scale = max(float(np.max(np.abs([self.a, self.b, self.c]))), self._frame.length)
        rounding = 4 * slack * scale
        room = max(rounding / self._frame.height, at_the_ends(slack))
        return np.all(shares >= -room, axis=1) & (off <= rounding)

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law."""
        a, b, c = (np.array(corner, dtype=float) for corner in (self.a, self.b, self.c))
        density = 1 / self.measure

        def place(u: np.ndarray) -> np.ndarray:
            s = np.sqrt(u[:, :1])
            return a + (s * (1 - u[:, 1:])) * (b - a) + (s * u[:, 1:]) * (c - a)

        def coordinates(x: np.ndarray, v: np.ndarray) -> np.ndarray:
            shares, _ = self._shares(x)
            s = np.clip(1 - shares[:, 0], 0.0, 1.0)
            along = np.clip(shares[:, 2] / np.where(s > 0, s, 1.0), 0.0, 1.0)
            return np.stack([s * s, along], axis=-1)

        return Law(("distance from a", "from b to c"), place, coordinates, lambda x: np.full(len(x), density))
