"""Heavy tails: may the variance of what was sampled be infinite?

Hill's (1975) estimate of the tail index from the largest deviations: with an index below 2 the variance is infinite, standard
errors mean nothing, and a mean that looks right or wrong may be neither.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

_KEPT = 1024
_LEAST = 64
_SURE = 3.3  # standard errors of the estimate


@dataclass(frozen=True)
class TailEstimate:
    """The largest deviations |x - centre| of a stream of numbers, in no order."""

    centre: float
    largest: np.ndarray = field(default_factory=lambda: np.empty(0))
    n: int = 0

    def after(self, x: np.ndarray) -> TailEstimate:
        """Return the tail after the numbers x (n,)."""
        both = np.concatenate([self.largest, np.abs(x - self.centre)])
        if len(both) > _KEPT:
            both = np.partition(both, len(both) - _KEPT)[-_KEPT:]
        return TailEstimate(self.centre, both, self.n + len(x))

    def index(self, part: int = 1) -> tuple[float, float]:
        """Return Hill's estimate of the tail index and its standard error; (inf, 0) where there are too few numbers.

        Of a thousandth of the sample, 64 numbers at least, or of 1/`part` of that: the bulk must not be taken for the tail.
        """
        k = int(np.clip(self.n // 1000, _LEAST, _KEPT - 1)) // part
        if self.n < 50 * _LEAST or len(self.largest) <= k:
            return math.inf, 0.0
        top = np.sort(self.largest)[::-1][: k + 1]
        if not top[-1] > 0:
            return math.inf, 0.0
        mean = float(np.mean(np.log(top[:-1] / top[-1])))
        index = 1 / mean if mean > 0 else math.inf
        return index, index / math.sqrt(k)

    def outermost(self) -> tuple[float, float]:
        """Return the index that the largest numbers go on with, and its error: of the outermost quarter, where that has another.

        A few outliers above a bulk, all alike, have none: (inf, 0).
        """
        index, error = self.index()
        further, more = self.index(4)
        return (index, error) if 0.5 < further / index < 2 else (further, more if further < math.inf else 0.0)

    def suspect(self) -> bool:
        """Whether the variance is infinite as far as the largest deviations tell.

        A power law has the same index further out; a few outliers above a bulk have not.
        """
        index, error = self.index()
        further, _ = self.index(4)
        return index + _SURE * error < 2 and 0.5 < further / index < 2
