"""A histogram on a k-d tree: a density in the unit cube that follows a pilot sample, drawn from and evaluated exactly.

The cells have equal numbers of pilot points. Each is halved at the median along its longest side, measured in
the spread of all points, and drawn in to its points as
long as it has many, so that the empty space around a narrow support is no part of any cell (Bentley 1975, with the shrinking of
Arya & Mount 1998). What the pilot misses is left to whoever mixes the histogram with a density that is nowhere zero.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

_BLOCK = 1 << 14  # points at once: what is computed of them stays in the cache
_CROWD = 64  # points of a cell that is drawn in to them
_MARGIN = 4.0  # mean distances of points along a side, by which more than they span is kept
_THINNEST = 1e-12  # spread of points along an axis: a thinner layer is not cut along it
_FLAT = 1e-300  # volume of a cell that cannot be drawn from


@dataclass(frozen=True)
class Tree:
    """A complete binary tree over [0, 1]^k; the children of node i are 2 i + 1 and 2 i + 2, the leaves have numbers of their own.

    depth  levels of nodes
    axis   (2^depth - 1,) along which each node is halved
    cut    (2^depth - 1,) where
    low, high  (2^depth, k) corners of the cell of each leaf
    share  (2^depth,) probability of each cell
    """

    depth: int
    axis: np.ndarray
    cut: np.ndarray
    low: np.ndarray
    high: np.ndarray
    share: np.ndarray

    @staticmethod
    def of(points: np.ndarray, per_leaf: int) -> Tree:
        """Return the tree of points (n, k) in the unit cube, with about `per_leaf` of them in each leaf."""
        n, k = points.shape
        depth = max(int(np.log2(max(n / per_leaf, 1))), 0)
        size = n >> depth
        cells = np.ascontiguousarray(points[: size << depth].T)[:, None]  # (k, cells, points): long rows reduce fast
        low, high = np.zeros((1, k)), np.ones((1, k))
        axes, cuts = [], []
        spread = np.quantile(points, [0.01, 0.99], axis=0) if n else np.stack([low[0], high[0]])
        scale = np.maximum(spread[1] - spread[0], _THINNEST)
        for _ in range(depth):
            least, most = cells.min(axis=2).T, cells.max(axis=2).T
            if cells.shape[2] >= _CROWD:
                margin = _MARGIN / cells.shape[2] * (most - least)
                low, high = np.maximum(low, least - margin), np.minimum(high, most + margin)
            axis = np.argmax((most - least) / scale, axis=1)
            rows, half = np.arange(cells.shape[1]), cells.shape[2] // 2
            along = cells[axis, rows]
            order = np.argpartition(along, half, axis=1)
            along = np.take_along_axis(along, order, axis=1)
            cut = 0.5 * (along[:, :half].max(axis=1) + along[:, half])
            left_high, right_low = high.copy(), low.copy()
            left_high[rows, axis] = np.clip(cut, low[rows, axis], high[rows, axis])
            right_low[rows, axis] = left_high[rows, axis]
            low = np.stack([low, right_low], axis=1).reshape(-1, k)
            high = np.stack([left_high, high], axis=1).reshape(-1, k)
            kept = order[:, : 2 * half]
            cells = np.stack([column[rows[:, None], kept].reshape(-1, half) for column in cells])
            axes.append(axis)
            cuts.append(cut)
        share = (np.prod(high - low, axis=1) > _FLAT).astype(float)
        joined = (np.concatenate(parts) if parts else np.empty(0) for parts in (axes, cuts))
        axis, cut = joined
        return Tree(depth, axis.astype(np.intp), cut, low, high, share / max(share.sum(), 1.0))

    def without(self, gone: np.ndarray) -> Tree:
        """Return the histogram without the marked leaves (2^depth,): the others share their probability."""
        if not gone.any():
            return self
        share = np.where(gone, 0.0, self.share > 0)
        return replace(self, share=share / max(share.sum(), 1.0))

    def leaf(self, u: np.ndarray) -> np.ndarray:
        """Return (n,) the leaf of each point (n, k)."""
        found = np.empty(len(u), dtype=np.intp)
        k = u.shape[1]
        for start in range(0, len(u), _BLOCK):
            flat = np.ascontiguousarray(u[start : start + _BLOCK]).ravel()
            first = np.arange(0, len(flat), k)
            node = np.zeros(len(first), dtype=np.intp)
            for _ in range(self.depth):
                above = flat.take(first + self.axis.take(node)) >= self.cut.take(node)
                node += node + 1
                node += above
            found[start : start + _BLOCK] = node - (len(self.share) - 1)
        return found

    def density(self, u: np.ndarray, leaf: np.ndarray) -> np.ndarray:
        """Return (n,) the density at points (n, k) of the given leaves (n,)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            height = np.where(self.share > 0, self.share / np.prod(self.high - self.low, axis=1), 0.0)
        inside = np.ones(len(u), dtype=bool)
        for axis in range(u.shape[1]):
            column = u[:, axis]
            inside &= column >= self.low[:, axis].take(leaf)
            inside &= column <= self.high[:, axis].take(leaf)
        return height.take(leaf) * inside

    def draw(self, rng: np.random.Generator, n: int) -> np.ndarray:
        """Return n points (n, k) of the histogram."""
        usable = np.flatnonzero(self.share > 0)
        leaf = usable[rng.integers(0, len(usable), n)]
        u = rng.random((n, self.low.shape[1]))
        for axis in range(u.shape[1]):
            low, high = self.low[:, axis], self.high[:, axis]
            u[:, axis] *= (high - low).take(leaf)
            u[:, axis] += low.take(leaf)
        return u
