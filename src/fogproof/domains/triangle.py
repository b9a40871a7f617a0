"""The flat triangle, in the plane or in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.domains.law import Law, at_the_ends
from fogproof.errors import InvalidValueError
from fogproof.validate import coordinates


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

    @property
    def _edges(self) -> np.ndarray:
        a, b, c = (np.array(corner, dtype=float) for corner in (self.a, self.b, self.c))
        return np.stack([b - a, c - a])

    @property
    def measure(self) -> float:
        """The area."""
        e = self._edges
        gram = e @ e.T
        return float(0.5 * np.sqrt(max(gram[0, 0] * gram[1, 1] - gram[0, 1] ** 2, 0.0)))

    def _shares(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (n, 2) how much of b and c is in each point, and (n,) its distance from the triangle's plane."""
        d, e = x - np.array(self.a, dtype=float), self._edges
        shares = d @ np.linalg.pinv(e)
        return shares, np.linalg.norm(d - shares @ e, axis=1)

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which points lie in the triangle."""
        (of_b, of_c), off = (lambda pair: (pair[0].T, pair[1]))(self._shares(x))
        scale = float(np.max(np.abs([self.a, self.b, self.c])))
        edges = self._edges
        size = float(np.max(np.abs(edges)))
        thin = size * size / (2 * self.measure)  # a thin triangle's shares lose as many digits
        room = max(4 * slack * max(scale / size, 1.0) * thin, at_the_ends(slack))
        inner = (of_b >= -room) & (of_c >= -room) & (of_b + of_c <= 1 + room)
        return inner & (off <= 4 * slack * max(scale, size))

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law."""
        a, e = np.array(self.a, dtype=float), self._edges
        density = 1 / self.measure

        def place(u: np.ndarray) -> np.ndarray:
            s = np.sqrt(u[:, :1])
            return a + (s * (1 - u[:, 1:])) * e[0] + (s * u[:, 1:]) * e[1]

        def coordinates(x: np.ndarray, v: np.ndarray) -> np.ndarray:
            shares, _ = self._shares(x)
            s = np.clip(shares.sum(axis=1), 0.0, 1.0)
            along = np.clip(shares[:, 1] / np.where(s > 0, s, 1.0), 0.0, 1.0)
            return np.stack([s * s, along], axis=-1)

        return Law(("distance from a", "from b to c"), place, coordinates, lambda x: np.full(len(x), density))
