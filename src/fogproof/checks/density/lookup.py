"""In which cell does each number lie? Exactly what `searchsorted` answers, in a fraction of its time.

A uniform grid of buckets narrows the search to the edges inside one bucket; crowded buckets have a second grid of their own, so
densities with peaks thousands of times narrower than the domain are no slower (Chen & Asau 1974, the guide table).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

_BLOCK = 1 << 14  # numbers at once: what is computed of them stays in the cache
_BELOW_ONE = 1 - 2.0**-53
_MOST_COMPARED = 3  # edges of one bucket that are compared one by one; fuller buckets are searched


@dataclass(frozen=True)
class Lookup:
    """Edges (m + 1,) and the two grids of buckets over them."""

    edges: np.ndarray
    following: np.ndarray
    scale: float
    buckets: int
    base: np.ndarray
    fine: np.ndarray
    first: np.ndarray
    most: int
    crowded: np.ndarray | None

    @staticmethod
    def of(edges: np.ndarray) -> Lookup:
        """Prepare the search; edges must be finite and strictly increasing."""
        cells = len(edges) - 1
        buckets = 2 * cells
        with np.errstate(over="ignore"):
            scale = buckets / (edges[-1] - edges[0])
        scale = scale if np.isfinite(scale) else 0.0
        inner = edges[1:-1]
        place = (inner - edges[0]) * scale
        coarse = np.minimum(place.astype(np.intp), buckets - 1)
        inside = np.bincount(coarse, minlength=buckets)
        fine = np.where(inside > 1, 4 * inside, 1)
        base = np.cumsum(fine) - fine
        bucket = base[coarse] + _sub(place, coarse, fine)
        filled = np.bincount(bucket, minlength=int(fine.sum()))
        most = int(filled.max(initial=0))
        crowded = filled > _MOST_COMPARED if most > _MOST_COMPARED else None
        following, first = np.append(inner, np.inf), np.cumsum(filled) - filled
        most = min(most, _MOST_COMPARED)
        small = [table.astype(np.int32) for table in (base, first)]  # they fit into the cache
        return Lookup(edges, following, scale, buckets, small[0], fine.astype(np.float32), small[1], most, crowded)

    @cached_property
    def even(self) -> bool:
        """Whether no bucket has a grid of its own: each is then its own place."""
        return bool(np.all(self.fine == 1))

    def __call__(self, t: np.ndarray) -> np.ndarray:
        """Return (n,) the cell of each t: the last i with edges[i] <= t, clipped to the cells that there are."""
        found = np.empty(len(t), dtype=np.intp)
        for start in range(0, len(t), _BLOCK):
            found[start : start + _BLOCK] = self._find(t[start : start + _BLOCK])
        return found

    def _find(self, t: np.ndarray) -> np.ndarray:
        place = (np.clip(t, self.edges[0], self.edges[-1]) - self.edges[0]) * self.scale
        coarse = np.minimum(place.astype(np.intp), self.buckets - 1)
        bucket = coarse if self.even else self.base.take(coarse) + _sub(place, coarse, self.fine)
        index = self.first.take(bucket)
        for _ in range(self.most):
            index += t >= self.following.take(index)
        if self.crowded is not None:
            slow = self.crowded[bucket]
            found = np.searchsorted(self.edges, t[slow], side="right") - 1
            index[slow] = np.clip(found, 0, len(self.edges) - 2)
        return index


def _sub(place: np.ndarray, coarse: np.ndarray, fine: np.ndarray) -> np.ndarray:
    inside = np.minimum(place - coarse, _BELOW_ONE)
    return (inside * fine.take(coarse)).astype(np.intp)
