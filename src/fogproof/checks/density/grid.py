"""The cells that samples are counted in: fine ones along each axis, coarse ones in the plane, and the probability of each.

The edges lie where the claimed density puts equal probabilities: they depend on nothing that the tested sample did. All
probabilities are those of the continuous part, given that a sample belongs to it: atoms are tested by themselves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fogproof.checks.density.lookup import Lookup

_PER_CELL = 16  # samples expected in a fine cell
_MOST_CELLS = {1: 1 << 17, 2: 1 << 16}
COARSE = 32  # cells along each axis of the plane
FINEST_PLANE = 512
_NO_BLUR = 1e-12  # of probability: what double precision does


@dataclass(frozen=True)
class Marginal:
    """One axis.

    label   what it is called
    edges   (m + 1,) of the cells, in the counted coordinate
    shown   (m + 1,) the edges as people are shown them
    cdf     (m + 1,) probability below each edge, from 0 to 1
    before  (m + 1,) bound on the error of the cdf from all that lies before the edge
    at_edge (m + 1,) bound on its error from the neighbourhood of the edge
    blur    (m + 1,) probability that the rounding of points moves a sample across the edge
    ends    whether the ends of the axis are ends of the domain
    lookup  finds the cell of a coordinate
    at      the cdf at any counted coordinates (q,)
    whole   whether the edges separate all points there are, as on `Discrete`
    """

    label: str
    edges: np.ndarray
    shown: np.ndarray
    cdf: np.ndarray
    before: np.ndarray
    at_edge: np.ndarray
    blur: np.ndarray
    ends: bool
    lookup: Lookup
    at: Callable[[np.ndarray], np.ndarray]
    whole: bool = False

    @cached_property
    def mass(self) -> np.ndarray:
        """The probability of each cell, (m,)."""
        return np.diff(self.cdf)

    @property
    def error(self) -> np.ndarray:
        """Bound on the error of the cdf at each edge, (m + 1,)."""
        return self.before + self.at_edge

    def doubt(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Return (q,) bounds on the error of the probability between edges number `first` and `last`, (q,) each."""
        with np.errstate(invalid="ignore"):
            inner = self.before[last] - self.before[first]
        return np.where(np.isnan(inner), np.inf, inner) + self.at_edge[first] + self.at_edge[last]

    @property
    def scores(self) -> np.ndarray:
        """The middle of each cell's probabilities, (m,): uniform on (0, 1) for a right sampler, but for the cells' width."""
        return 0.5 * (self.cdf[:-1] + self.cdf[1:])


@dataclass(frozen=True)
class GridPlane:
    """The cells of two axes together.

    rows         two (m,) arrays: the row or column of the counted plane that each fine cell of an axis belongs to
    shares       two (size,) arrays: the probability of each counted row and column
    along        (size + 1,) probability that rounding moves a sample across each edge of the counted rows
    across       (size,) probability that it moves a sample of each row into or out of one of its cells
    mass         (32, 32) probability of the coarse cells
    error        (32, 32) bound on its error
    independent  whether the axes are independent: finer cells then have known probabilities too
    """

    rows: tuple[np.ndarray, np.ndarray]
    shares: tuple[np.ndarray, np.ndarray]
    along: np.ndarray
    across: np.ndarray
    mass: np.ndarray
    error: np.ndarray
    independent: bool

    @property
    def size(self) -> int:
        """Rows, and columns, that are counted."""
        return len(self.shares[0])

    def coarse(self, cells: list[np.ndarray]) -> np.ndarray:
        """Return (n,) the coarse cell, row by row, of points in the given fine cells (n,) of the two axes."""
        first, second = (rows[cell] for rows, cell in zip(self._coarse_rows, cells, strict=True))
        return np.asarray(first + second)

    @cached_property
    def _coarse_rows(self) -> tuple[np.ndarray, np.ndarray]:
        """What the fine cells of the two axes add to the number of a coarse cell, (m,) each."""
        side, size = len(self.mass), self.size
        first, second = (rows * side // size for rows in self.rows)
        return first * side, second

    def blur(self, size: int) -> np.ndarray:
        """Return (size, size) the probability that rounding moves into or out of each of as many cells."""
        if max(float(self.along.max()), float(self.across.max())) < _NO_BLUR:
            return np.zeros((size, size))
        step = self.size // size
        share = self.shares[1].reshape(size, step).sum(axis=1)
        rows = self.along[::step][:-1] + self.along[::step][1:]
        return np.asarray(rows[:, None] * share + self.across.reshape(size, step).sum(axis=1)[:, None])


@dataclass(frozen=True)
class Grid:
    """All cells of a domain."""

    marginals: tuple[Marginal, ...]
    plane: GridPlane | None


def cells_wanted(samples: int, axes: int) -> int:
    """Return how many fine cells an axis gets: a power of two."""
    return 1 << int(np.clip(np.log2(max(samples, 1) / _PER_CELL), 4, np.log2(_MOST_CELLS[axes])))
