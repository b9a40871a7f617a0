"""Serial correlation: does a sample know its predecessor?

Sorted or stratified output, generators that start again, parameters that are set one call too late: the distribution can be perfect
and the samples still not independent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.checks.tails import chi_square_above
from fogproof.checks.verdict import Finding, Outcome


@dataclass(frozen=True)
class Successions:
    """Sums over the scores (n, k) of one stream of samples, less their claimed mean 1/2.

    sums      (k,) of the scores
    products  (k, k) of each sample's scores with the next one's
    squares   (k, k) of each sample's scores with its own
    n, pairs  how many samples and how many successions
    """

    sums: np.ndarray
    products: np.ndarray
    squares: np.ndarray
    n: int
    pairs: int

    @staticmethod
    def of(scores: list[np.ndarray]) -> Successions:
        """Return the sums of one batch; scores are (n,) for each axis."""
        d = [score - 0.5 for score in scores]
        n = len(d[0])
        sums = np.array([one.sum() for one in d])
        products = np.array([[np.einsum("i,i->", one[:-1], other[1:]) for other in d] for one in d])
        squares = np.array([[np.einsum("i,i->", one, other) for other in d] for one in d])
        return Successions(sums, products, squares, n, max(n - 1, 0))

    def merged(self, other: Successions) -> Successions:
        """Return the sums of both streams."""
        return Successions(
            self.sums + other.sums,
            self.products + other.products,
            self.squares + other.squares,
            self.n + other.n,
            self.pairs + other.pairs,
        )


def serial_test(name: str, sums: Successions | None, alpha: float) -> Finding:
    """Test that successive samples are uncorrelated, within each axis and across: chi-square with k^2 degrees of freedom."""
    none = Finding(name, "not rejected", "too few different samples to see a correlation", 1.0, alpha)
    if sums is None:
        return none
    k = len(sums.products)
    mean = sums.sums / max(sums.n, 1)
    covariance = sums.squares / max(sums.n, 1) - np.outer(mean, mean)
    if sums.pairs < 100 or not np.linalg.det(covariance) > 1e-12 * (1 / 12) ** k:
        return none
    inverse = np.linalg.inv(covariance)
    r = sums.products / sums.pairs - np.outer(mean, mean)
    statistic = float(sums.pairs * np.trace(inverse @ r @ inverse @ r.T))
    p = chi_square_above(k * k, statistic)
    rejected = p <= alpha
    outcome: Outcome = "rejected" if rejected else "not rejected"
    scale = np.sqrt(np.diag(covariance))
    coefficient = r / np.outer(scale, scale)
    largest = float(coefficient.flat[np.argmax(np.abs(coefficient))])
    message = f"correlation of successive samples is {largest:+.3g}"
    exact = sums.pairs >= 1000
    return Finding(name, outcome, message, p, alpha, exact, statistic, largest, cause="correlation" if rejected else "")
