"""Scores of labels: smooth misfits in any number of dimensions.

Cells see what is wrong in one place. An error of a formula or a parameter is small everywhere instead, and in several dimensions
each cell has too few points to tell. The residuals "label - w" of the label test are therefore also weighed with a few smooth
functions of the point, first and second Legendre polynomials of each coordinate and products of two: Rao's score test (1948) of a
claim that is off by such a function. Given the points, the weighed sums have mean 0 and a known covariance, without one integral.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.tails import chi_square_above, chi_square_detected
from fogproof.checks.verdict import Finding, Resolution

_KNOTS = 33  # quantiles of the pilot along an axis: between them its ranks are interpolated
_BLOCK = 1 << 13  # points at once: what is computed of them stays in the cache
_MOST = 80  # functions: products of axes far from each other are left out beyond
_TELLING = 400.0  # variance of a weighed sum whose law is the normal one
_FAR = 1e-4  # p-values below it are corrected for skewness
_RATIO = "root mean square of the ratio of densities less 1"
_EXPONENT = 600.0  # largest of that correction: no p-value that is not 0 needs more


@dataclass(frozen=True)
class Basis:
    """The smooth functions of the coordinates of a point.

    knots  for each axis, (m,) increasing quantiles of the pilot
    ranks  for each axis, (m,) the ranks of the knots, from -1 to 1
    pairs  (q, 2) axes whose first polynomials are multiplied
    """

    knots: tuple[np.ndarray, ...]
    ranks: tuple[np.ndarray, ...]
    pairs: np.ndarray

    @staticmethod
    def of(u: np.ndarray) -> Basis:
        """Return the basis for coordinates like those of the pilot, (n, k)."""
        k = u.shape[1]
        level = np.linspace(0, 1, _KNOTS)
        inside = np.quantile(u, level, axis=0).T if len(u) else np.tile(level, (k, 1))
        knots, ranks = [], []
        for column in inside:
            column[[0, -1]] = 0.0, 1.0  # the pilot has not been everywhere
            kept, at = np.unique(column, return_index=True)
            knots.append(kept)
            ranks.append(2 * level[at] - 1)
        pairs = sorted(combinations(range(k), 2), key=lambda pair: pair[1] - pair[0])[: max(_MOST - 2 * k, 0)]
        return Basis(tuple(knots), tuple(ranks), np.array(pairs, dtype=np.intp).reshape(-1, 2))

    @property
    def size(self) -> int:
        """The number of functions."""
        return 2 * len(self.knots) + len(self.pairs)

    def at(self, u: np.ndarray) -> np.ndarray:
        """Return (size, n) the functions at coordinates (n, k)."""
        k = len(self.knots)
        found = np.empty((self.size, len(u)))
        for axis, (knots, ranks) in enumerate(zip(self.knots, self.ranks, strict=True)):
            t = np.interp(u[:, axis], knots, ranks)
            found[axis], found[k + axis] = math.sqrt(3) * t, math.sqrt(5) * (1.5 * t * t - 0.5)
        for row, (first, second) in enumerate(self.pairs.tolist()):
            found[2 * k + row] = found[first] * found[second]
        return found

    def weighed(self, u: np.ndarray, labels: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return sums (size,) of the residuals of points at u (n, k), weighed with the functions, and what they are measured by.

        That is (2, size + 1, size + 1) sums of products of two functions, the last of which is 1: weighed with w (1 - w), they are
        the covariance, and with w, the number of samples times the means of those products under the claim.
        """
        total, products = np.zeros(self.size), np.zeros((2, self.size + 1, self.size + 1))
        functions = np.ones((self.size + 1, min(len(u), _BLOCK)))
        for start in range(0, len(u), _BLOCK):
            block = slice(start, start + _BLOCK)
            f, here = functions[:, : len(u[block])], w[block]
            f[:-1] = self.at(u[block])
            total += f[:-1] @ (labels[block] - here)
            claimed = (f * here) @ f.T
            products += claimed - (f * here**2) @ f.T, claimed
        return total, products


def scores(name: str, total: np.ndarray, products: np.ndarray, alpha: float) -> Finding:
    """Test weighed sums (q,), see `Basis.weighed` for `products`."""
    values, vectors = np.linalg.eigh(products[0, :-1, :-1])
    told = values >= _TELLING
    if not told.any():  # whether that leaves the verdict open, the sum of all residuals says
        message = "too few coins are in doubt to be weighed: nothing was looked at"
        return Finding(name, "not rejected", message, alpha=alpha)
    z = (vectors[:, told].T @ total) / np.sqrt(values[told])
    statistic, freedom = float(z @ z), int(told.sum())
    p = chi_square_above(freedom, statistic)
    if p < _FAR:  # far out, a sum of bounded terms may decay as slowly as Bernstein's bound (1924)
        heavier = math.sqrt(statistic / float(values[told].min())) / 3
        p = min(_FAR, p * math.exp(min(0.5 * statistic * heavier / (1 + heavier), _EXPONENT)))
    rejected = p <= alpha
    weakest = _most_of_least(products[1, :-1, :-1] / products[1, -1, -1], values[told], vectors[:, told])
    seen = math.sqrt(chi_square_detected(freedom, alpha, MISS) * weakest)
    return Finding(
        name,
        "rejected" if rejected else "not rejected",
        f"chi-square = {statistic:.4g} on {freedom} smooth functions",
        p,
        alpha,
        p >= _FAR,
        statistic,
        math.sqrt(max(statistic - freedom, 0.0) * weakest),
        Resolution(f"part of a misfit along {freedom} smooth functions ({_RATIO})", seen * (1 + 0.5 * seen), MISS),
        cause="shape" if rejected else "",
    )


def _most_of_least(gram: np.ndarray, values: np.ndarray, vectors: np.ndarray) -> float:
    """Return the largest mean square of a misfit along the functions that adds 1 to the statistic.

    gram              (q, q) means of products of two functions under the claim
    values, vectors   (r,), (q, r) of the covariance: a misfit c f adds c' covariance c, and its mean square is c' gram c
    """
    inner = vectors.T @ gram @ vectors / np.sqrt(values * values[:, None])
    return float(np.linalg.eigvalsh(inner)[-1])
