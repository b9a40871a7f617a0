"""Several domains together: point and direction, distance and direction, lobe and direction, wavelength and point."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from fogproof.domains.law import Domain, Law, vector_columns, whole_columns
from fogproof.errors import InvalidValueError


@dataclass(frozen=True, init=False)
class Product:
    """Points of several domains side by side, (n, columns of all); the pdf is per product of their measures.

    `Product(Interval(0, 1), UnitSphere())` has points (t, x, y, z) and a pdf per unit length and steradian.
    All columns are floats, those of `Discrete` too: a table beside another coordinate is indexed with x[:, 0].astype(int).
    """

    parts: tuple[Domain, ...]

    def __init__(self, *parts: Domain) -> None:
        """Take two domains or more, in the order of their columns."""
        if len(parts) < 2 or not all(isinstance(part, Domain) for part in parts):
            raise InvalidValueError("parts", "must be two domains or more", parts)
        object.__setattr__(self, "parts", parts)

    def __repr__(self) -> str:
        return f"Product({', '.join(map(repr, self.parts))})"

    @property
    def shape(self) -> tuple[int, ...]:
        """All columns."""
        return (sum(math.prod(part.shape) for part in self.parts),)

    @property
    def whole(self) -> tuple[bool, ...]:
        """Which columns hold whole numbers, which no rounding moves."""
        return tuple(one for part in self.parts for one in whole_columns(part))

    @property
    def vectors(self) -> tuple[tuple[int, int], ...]:
        """Which columns hold directions."""
        starts = itertools.accumulate((math.prod(part.shape) for part in self.parts), initial=0)
        pairs = zip(starts, self.parts, strict=False)
        return tuple((start + first, start + last) for start, part in pairs for first, last in vector_columns(part))

    @property
    def measure(self) -> float:
        """The product of the measures."""
        return math.prod(part.measure for part in self.parts)

    def _split(self, x: np.ndarray) -> list[np.ndarray]:
        columns, first = [], 0
        for part in self.parts:
            last = first + math.prod(part.shape)
            columns.append(x[:, first:last] if part.shape else x[:, first])
            first = last
        return columns

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which points have every part in its domain."""
        pairs = zip(self.parts, self._split(x), strict=True)
        return np.all([part.contains(columns, slack) for part, columns in pairs], axis=0)

    def law(self, pilot: np.ndarray) -> Law:
        """Return the product of the known laws: independent parts."""
        pieces = self._split(pilot) if len(pilot) else [np.empty((0, *part.shape)) for part in self.parts]
        laws = [part.law(columns) for part, columns in zip(self.parts, pieces, strict=True)]
        ends = np.cumsum([len(law.axes) for law in laws])[:-1]
        names = [axis for law in laws for axis in law.axes]
        axes = tuple(f"{name} {i + 1}" if names.count(name) > 1 else name for i, name in enumerate(names))

        def place(u: np.ndarray) -> np.ndarray:
            parts = zip(laws, np.split(u, ends, axis=1), strict=True)
            return np.column_stack([law.place(columns) for law, columns in parts])

        def coordinates(x: np.ndarray, v: np.ndarray) -> np.ndarray:
            parts = zip(laws, self._split(x), np.split(v, ends, axis=1), strict=True)
            return np.column_stack([law.coordinates(columns, w) for law, columns, w in parts])

        def density(x: np.ndarray) -> np.ndarray:
            parts = zip(laws, self._split(x), strict=True)
            return np.asarray(math.prod(law.density(columns) for law, columns in parts))

        return Law(axes, place, coordinates, density, any(law.stepped for law in laws))
