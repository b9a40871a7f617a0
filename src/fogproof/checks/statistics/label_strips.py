"""Labels in strips along each axis, and in squares of two axes: misfits that repeat, in several dimensions.

The cells of the tree halve one axis after the other: in several dimensions each axis is cut a few times only, and what rises and
falls along one of them, such as a table looked up with the wrong interpolation or the share of a wavelength, is evened out. Here
the residuals "label - w" are summed in strips across one axis, whatever the others are, and in squares of two, finely and coarsely.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.chi_square import pooled
from fogproof.checks.statistics.residuals import LEAST, chi_square, detected, sums_in
from fogproof.checks.verdict import Finding, Resolution

CELLS = 256  # strips of an axis, and squares of a pair of axes: 16 by 16
_SIDE = 16
_MOST = 16  # axes and pairs: pairs of axes far from each other are left out beyond
_COARSER = 4  # cells of one level in a cell of the next
_LEVELS = 3  # 256, 64 and 16 cells


def _square() -> np.ndarray:
    """Return (16, 16) numbers of squares along a curve: four neighbours make a square of the next level (Morton 1966)."""
    bits = np.array([sum(((i >> b) & 1) << (2 * b) for b in range(4)) for i in range(_SIDE)])
    return np.asarray(bits[:, None] + 2 * bits[None, :])


_NUMBERS = _square()


@dataclass(frozen=True)
class Strips:
    """Where axes are cut.

    edges  (k, 255) quantiles of the pilot along each axis
    pairs  axes of which squares are looked at
    """

    edges: np.ndarray
    pairs: tuple[tuple[int, int], ...]

    @staticmethod
    def of(u: np.ndarray) -> Strips:
        """Return the strips for coordinates like those of the pilot, (n, k); none for a single axis: the tree has them."""
        k = u.shape[1]
        level = np.arange(1, CELLS) / CELLS
        edges = np.quantile(u, level, axis=0).T if len(u) else np.tile(level, (k, 1))
        near = sorted(combinations(range(k), 2), key=lambda pair: pair[1] - pair[0])
        axes = min(k, _MOST) if k > 1 else 0
        return Strips(np.ascontiguousarray(edges[:axes]), tuple(near[: _MOST - axes]) if axes else ())

    @property
    def size(self) -> int:
        """The number of axes and pairs."""
        return len(self.edges) + len(self.pairs)

    def named(self, row: int, axes: tuple[str, ...]) -> str:
        """Return the name of an axis or a pair."""
        k = len(self.edges)
        return axes[row] if row < k else " and ".join(axes[i] for i in self.pairs[row - k])

    def sums(self, u: np.ndarray, labels: np.ndarray, w: np.ndarray) -> np.ndarray:
        """Return (4, size, 256) sums of residuals of points at u (n, k), as in `Sums`."""
        found = np.zeros((4, self.size, CELLS))
        if not self.size or not len(u):
            return found
        along = [np.searchsorted(edges, u[:, axis], side="right") for axis, edges in enumerate(self.edges)]
        for axis, cell in enumerate(along):
            found[:, axis] = sums_in(cell, CELLS, labels, w)
        coarse = [cell >> 4 for cell in along]
        for row, (first, second) in enumerate(self.pairs, start=len(along)):
            found[:, row] = sums_in(_NUMBERS[coarse[first], coarse[second]], CELLS, labels, w)
        return found


def strips(name: str, where: Strips, axes: tuple[str, ...], sums: np.ndarray, alpha: float) -> Finding:
    """Test sums (4, size, 256): the most conspicuous chi-square of all axes, pairs and levels, its p-value times their number."""
    rivals = sums.shape[1] * _LEVELS
    best: tuple[float, float, int, int, int] = (2.0, 0.0, 0, 0, 0)
    coarse, doubt = 0, 0.0
    for row in range(sums.shape[1]):
        for level in range(_LEVELS):
            columns = sums[:, row].reshape(4, CELLS // _COARSER**level, -1).sum(axis=2)
            if columns[1].sum() < 2 * LEAST:
                continue
            p, statistic, cells = chi_square(columns)
            best = min(best, (p, statistic, cells, row, columns.shape[1]))
            if level == _LEVELS - 1:
                coarse, doubt = max(coarse, int(pooled(columns[1], LEAST).max()) + 1), float(columns[1].sum())
    if best[0] > 1:
        return Finding(name, "not rejected", "too few coins are in doubt: nothing was looked at", alpha=alpha)
    p, statistic, cells, row, parts = best
    p = min(p * rivals, 1.0)
    rejected = p <= alpha
    place = f"{parts} {'strips' if row < len(where.edges) else 'squares'} of {where.named(row, axes)}"
    seen = detected(coarse, alpha / rivals, doubt)
    kind = f"misfit that is even in each of {coarse} cells along one axis (root mean square of the ratio of densities less 1)"
    return Finding(
        name,
        "rejected" if rejected else "not rejected",
        f"the most conspicuous are {place}: chi-square = {statistic:.5g} on {cells} degrees of freedom",
        p,
        alpha,
        False,
        statistic,
        max((statistic - cells) / max(doubt, 1.0), 0.0) ** 0.5,
        Resolution(kind, seen, MISS),
        cause="shape" if rejected else "",
    )
