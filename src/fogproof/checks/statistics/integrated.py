"""An integral by points of a known law: the mean of f / q, and whether its standard error may be believed.

Where f lies far above q at places that few points meet, the sample knows neither the mean nor its own spread: then one point has a
large share of the sum of squares (Geweke 1989), and no interval is stated.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

_LARGEST = 0.05  # share of one point in the sum of squares, beyond which the standard error may be wrong
_LEAST = 1000  # points that tell anything


@dataclass(frozen=True)
class Integrated:
    """Sums (5,): how many points, of the ratios f / q there, of their squares and fourth powers, how many points say nothing."""

    sums: np.ndarray

    @staticmethod
    def of(ratio: np.ndarray) -> Integrated:
        """Return the sums over ratios (n,); one that is not finite says nothing."""
        told = ratio[np.isfinite(ratio)]
        square = np.square(told)
        return Integrated(np.array([len(ratio), told.sum(), square.sum(), square @ square, len(ratio) - len(told)]))

    @property
    def n(self) -> float:
        """How many points there are, or 1."""
        return max(float(self.sums[0]), 1.0)

    @property
    def mean(self) -> float:
        """The integral."""
        return float(self.sums[1]) / self.n

    @property
    def error(self) -> float:
        """Its standard error."""
        return math.sqrt(max(float(self.sums[2]) / self.n - self.mean**2, 0.0) / self.n)

    @property
    def largest(self) -> float:
        """What the largest ratio adds to the mean, or a little more."""
        return float(self.sums[3]) ** 0.25 / self.n

    @property
    def dominated(self) -> bool:
        """Whether one point has so large a share of the sum of squares that few others tell how often its like occurs."""
        return math.sqrt(float(self.sums[3])) > _LARGEST * float(self.sums[2])

    @property
    def why_unknown(self) -> str:
        """Why the mean says nothing at all, "" if it does."""
        if self.n < _LEAST:
            return "there are too few points of the known law"
        if self.sums[4]:
            return "there are places where rounding hides the pdf"
        return "" if math.isfinite(self.sums[3]) else "the pdf is too large at single points"

    @property
    def why_not(self) -> str:
        """Why mean and standard error are no interval, "" if they are one."""
        heavy = "the pdf is high where few points of the known law are"
        return self.why_unknown or (heavy if self.dominated else "")
