"""Unbiased ray marching (Kettunen, d'Eon, Pantaleoni & Novák 2021): a power series around estimates that are good already.

Each of N + 1 combs, equidistant looks behind an offset of their own, estimates -tau well. Around each as pivot X_i the rest of the
exponential is a series of the others' differences, of which all products of k are averaged:

    T = mean over i of exp(X_i) sum_(k <= N) w_k/k! e_k(X_j - X_i, j != i)/binomial(N, k).

N is 0 in nine cases of ten, else at least 2, and goes on to k with probability 2/k; w_k is one over the chance to reach k.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import InvalidValueError
from fogproof.estimators.tracking.ray_looks import MOST_LOOK_UPS, RayLooks
from fogproof.scene import AnyMedium, Ray

STAYS = 0.9
"""Probability of N = 0."""

SURE = 2
"""Order that is reached by all others."""

MEAN_ORDER = 0.31945

BLOCK = 1 << 20
"""Looks at a time."""


@dataclass(frozen=True, eq=False)
class UnbiasedMarch:
    """Transmittance along one ray by unbiased ray marching.

    points  looks of each comb; None for as many as the paper's formula takes for the optical depth of the medium's bound
    """

    medium: AnyMedium
    ray: Ray
    points: int | None = None

    def __post_init__(self) -> None:
        checked_points(self.points)

    @cached_property
    def _along(self) -> RayLooks:
        return RayLooks(self.medium, self.ray)

    @cached_property
    def looks(self) -> int:
        """How many looks a comb has."""
        if self.points is not None:
            return self.points
        depth = self._along.bound() * self._along.length
        needed = math.ceil(((0.015 + depth) * (0.65 + depth) * (60.3 + depth)) ** (1 / 3))
        return max(1, math.floor(needed / (MEAN_ORDER + 1) + 0.5))

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n,), at the cost of their looks."""
        orders = _orders(rng, n)
        value = np.empty(n)
        for N in np.unique(orders):
            (which,) = np.nonzero(orders == N)
            size = max(1, BLOCK // (self.looks * (N + 1)))
            for some in np.array_split(which, math.ceil(len(which) / size)):
                X = -self._along.combs(rng, len(some) * (N + 1), self.looks).reshape(-1, N + 1)
                value[some] = _mean_of_pivots(X)
        return Draws(value, self.looks * (orders + 1.0))


def checked_points(points: int | None) -> None:
    """Refuse what is no count of looks."""
    if points is not None and (
        isinstance(points, bool) or not isinstance(points, int) or not 1 <= points <= MOST_LOOK_UPS
    ):
        raise InvalidValueError("points", f"must be a whole number in [1, {MOST_LOOK_UPS:g}]", points)


def _orders(rng: np.random.Generator, n: int) -> np.ndarray:
    """Return the order at which each series ends."""
    orders = np.where(rng.random(n) < STAYS, 0, SURE)
    alive = np.flatnonzero(orders)
    k = SURE
    while len(alive):
        k += 1
        alive = alive[rng.random(len(alive)) < 2 / k]
        orders[alive] = k
    return orders


def _mean_of_pivots(X: np.ndarray) -> np.ndarray:
    """Return the estimate from X (n, N + 1)."""
    N = X.shape[1] - 1
    total = np.zeros(len(X))
    for i in range(N + 1):
        others = np.delete(X, i, axis=1) - X[:, i, None]
        e = np.zeros((N + 1, len(X)))  # elementary symmetric polynomials, one difference after the other
        e[0] = 1
        for j in range(N):
            for k in range(j + 1, 0, -1):
                e[k] += e[k - 1] * others[:, j]
        reached, series = 1.0, np.ones(len(X))
        for k in range(1, N + 1):
            reached *= 1 - STAYS if k == 1 else 1.0 if k <= SURE else 2 / k
            series += e[k] / (reached * math.factorial(k) * math.comb(N, k))
        total += np.exp(X[:, i]) * series
    return total / (N + 1)
