"""Serial correlation: does a sample know its predecessor?

Sorted or stratified output, generators that start again, parameters that are set one call too late: the distribution can be perfect
and the samples still not independent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.checks.statistics.tails import chi_square_above
from fogproof.checks.verdict import Finding, Outcome

_UNIT = 2.0**15
_STRONG = 0.5  # a correlation that leaves little of the sample


@dataclass(frozen=True)
class Successions:
    """Sums over the scores (n, k) of one stream of samples, less their claimed mean 1/2, in whole units of 2^-15.

    Whole numbers add up to the same in any order: batches may be counted anywhere.

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
    def of(d: list[np.ndarray]) -> Successions:
        """Return the sums of one batch; d holds the scores (n,) of each axis, in units, see `in_units`."""
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


def in_units(scores: np.ndarray) -> np.ndarray:
    """Return scores on (0, 1) less 1/2, in whole units."""
    return np.rint((scores - 0.5) * _UNIT).astype(np.int64)


def serial_test(name: str, sums: Successions | None, alpha: float) -> Finding:
    """Test that successive samples are uncorrelated, within each axis and across: chi-square with k^2 degrees of freedom."""
    none = Finding(name, "not rejected", "too few different samples to see a correlation", 1.0, alpha)
    if sums is None:
        return none
    k = len(sums.products)
    mean = sums.sums / (max(sums.n, 1) * _UNIT)
    covariance = sums.squares / (max(sums.n, 1) * _UNIT**2) - np.outer(mean, mean)
    if sums.pairs < 100 or not np.linalg.det(covariance) > 1e-12 * (1 / 12) ** k:
        return none
    inverse = np.linalg.inv(covariance)
    r = sums.products / (sums.pairs * _UNIT**2) - np.outer(mean, mean)
    statistic = float(sums.pairs * np.trace(inverse @ r @ inverse @ r.T))
    p = chi_square_above(k * k, statistic)
    rejected = p <= alpha
    outcome: Outcome = "rejected" if rejected else "not rejected"
    scale = np.sqrt(np.diag(covariance))
    coefficient = r / np.outer(scale, scale)
    largest = float(coefficient.flat[np.argmax(np.abs(coefficient))])
    message = f"correlation of successive samples is {largest:+.3g}"
    exact = sums.pairs >= 1000
    cause = "dependent samples" if abs(largest) > _STRONG else "correlation"
    return Finding(name, outcome, message, p, alpha, exact, statistic, largest, cause=cause if rejected else "")
