"""Boxes with edges along the axes: the unit square, the rectangle, and the box of any dimension."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fogproof.domains.law import Law, at_the_ends
from fogproof.errors import InvalidValueError
from fogproof.validate import coordinates

_NAMES = "xyz"


def contained(low: np.ndarray, high: np.ndarray, x: np.ndarray, slack: float) -> np.ndarray:
    """Return (n,) which points (n, k) lie between two corners (k,)."""
    room = np.maximum(slack * np.maximum(np.abs(low), np.abs(high)), at_the_ends(slack) * (high - low))
    inside = np.ones(x.shape[:-1], dtype=bool)
    for axis, (least, most) in enumerate(zip((low - room).tolist(), (high + room).tolist(), strict=True)):
        inside &= (x[..., axis] >= least) & (x[..., axis] <= most)  # a reduction over few numbers would be slow
    return inside


def uniform(low: np.ndarray, high: np.ndarray) -> Law:
    """Return the uniform law between two corners (k,)."""
    k, size = len(low), high - low
    axes = tuple(_NAMES[:k]) if k <= len(_NAMES) else tuple(f"x{i}" for i in range(k))
    density = 1 / math.prod(size.tolist())
    return Law(
        axes,
        lambda u: low + size * u,
        lambda x, v: np.clip((x - low) / size, 0.0, 1.0),
        lambda x: np.full(len(x), density),
    )


def _corners(low: Sequence[float], high: Sequence[float]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    lows, highs = coordinates("low", low), coordinates("high", high)
    if len(lows) < 1 or not all(math.isfinite(a) for a in lows):
        raise InvalidValueError("low", "must be one or more finite numbers", low)
    if len(highs) != len(lows) or not all(a < b < math.inf for a, b in zip(lows, highs, strict=False)):
        raise InvalidValueError("high", f"must be finite and greater than low = {lows}, number by number", high)
    return lows, highs


@dataclass(frozen=True)
class UnitSquare:
    """The square [0, 1]^2; the pdf is per unit area."""

    shape = (2,)
    measure = 1.0

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which points lie in the square."""
        return contained(np.zeros(2), np.ones(2), x, slack)

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law."""
        return uniform(np.zeros(2), np.ones(2))


@dataclass(frozen=True)
class Box:
    """The points between two corners of k numbers each; the pdf is per unit volume (length, area, ...)."""

    low: tuple[float, ...]
    high: tuple[float, ...]

    def __post_init__(self) -> None:
        low, high = _corners(self.low, self.high)
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "high", high)

    @property
    def shape(self) -> tuple[int, ...]:
        """One number an axis."""
        return (len(self.low),)

    @property
    def measure(self) -> float:
        """The volume."""
        return math.prod(b - a for a, b in zip(self.low, self.high, strict=True))

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which points lie between the corners."""
        return contained(np.array(self.low), np.array(self.high), x, slack)

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law."""
        return uniform(np.array(self.low), np.array(self.high))


@dataclass(frozen=True)
class Rectangle:
    """The rectangle between two corners of two numbers each; the pdf is per unit area."""

    low: tuple[float, float]
    high: tuple[float, float]

    shape = (2,)

    def __post_init__(self) -> None:
        low, high = _corners(self.low, self.high)
        if len(low) != 2:
            raise InvalidValueError("low", "must be two numbers", self.low, fix="use Box for more")
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "high", high)

    @property
    def measure(self) -> float:
        """The area."""
        return (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which points lie between the corners."""
        return contained(np.array(self.low), np.array(self.high), x, slack)

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law."""
        return uniform(np.array(self.low), np.array(self.high))
