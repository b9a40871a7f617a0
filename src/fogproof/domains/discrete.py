"""Whole numbers from 0 on, with or without an end."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fogproof.domains.law import Law
from fogproof.domains.line import Tail
from fogproof.errors import InvalidValueError

_MANY = 1e5  # medians: the probability of a number so large is the density at it


@dataclass(frozen=True)
class Discrete:
    """The integers 0 … n - 1, or all from 0 on for n = math.inf; the pdf is a probability.

    Functions of its points get integers, with which a table may be indexed; for n = math.inf floats, which hold any of them.
    """

    n: float

    shape = ()
    whole = (True,)

    def __post_init__(self) -> None:
        whole = isinstance(self.n, int) and not isinstance(self.n, bool) and self.n >= 1
        if not whole and self.n != math.inf:
            raise InvalidValueError("n", "must be a whole number >= 1, or math.inf", self.n)

    @property
    def measure(self) -> float:
        """How many numbers there are."""
        return float(self.n)

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which numbers are whole and in range."""
        return (x == np.floor(x)) & (x >= 0) & (x < self.n)

    def law(self, pilot: np.ndarray) -> Law:
        """Return equal probabilities, or without an end the whole part of a log-logistic number."""
        n = self.n
        if n < math.inf:
            return Law(
                ("x",),
                lambda u: np.minimum(np.floor(u[:, 0] * n), n - 1),
                lambda x, v: np.minimum((x[:, None] + v) / n, 1.0),
                lambda x: np.full(len(x), 1 / n),
                True,
            )
        tail = Tail.of(pilot + 0.5)

        def density(x: np.ndarray) -> np.ndarray:
            difference = tail.cdf(x + 1) - tail.cdf(x)
            return np.where(x > _MANY * tail.m, tail.density(x + 0.5), difference)

        def coordinates(x: np.ndarray, v: np.ndarray) -> np.ndarray:
            low, high = tail.cdf(x[:, None]), tail.cdf(x[:, None] + 1)
            return low + v * (high - low)

        return Law(("x",), lambda u: np.floor(tail.quantile(u[:, 0])), coordinates, density, True)
