"""Transmittance by a power series (Bhanot & Kennedy 1985; Georgiev et al. 2019): exp(-tau) = exp(-c) sum_k (c - tau)^k/k!.

Each factor c - tau is estimated by one look at a uniform place. The series ends at random: order k is reached with probability
min(1, r/1) … min(1, r/k), by which its term is divided. That is unbiased for every pivot c and reach r > 0; terms change sign where
the pivot does not bound the optical depth of all looks.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fogproof.contracts import Draws
from fogproof.estimators.tracking.ray_looks import RayLooks
from fogproof.scene import AnyMedium, Ray
from fogproof.validate import number


@dataclass(frozen=True, eq=False)
class PowerSeriesTransmittance:
    """Transmittance along one ray by a power series.

    pivot  c, the optical depth around which the exponential is expanded; None for that of the medium's bound
    reach  r, the order up to which the series nearly always goes; as large as the pivot is where looks vary a lot
    """

    medium: AnyMedium
    ray: Ray
    pivot: float | None = None
    reach: float = 2.0

    def __post_init__(self) -> None:
        number("reach", self.reach, "must be finite and > 0", 0, open_ends=True)
        if self.pivot is not None:
            number("pivot", self.pivot, "must be finite and >= 0", 0)

    @cached_property
    def _along(self) -> RayLooks:
        return RayLooks(self.medium, self.ray)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n,), at the cost of their looks."""
        along = self._along
        start, stop = along.ends
        pivot = along.bound() * along.length if self.pivot is None else self.pivot
        value, term, cost = np.ones(n), np.ones(n), np.zeros(n)
        alive, order = np.arange(n if stop > start else 0), 0
        while len(alive):
            order += 1
            goes_on = min(1.0, self.reach / order)
            alive = alive[rng.random(len(alive)) < goes_on]
            sigma = along.sigma(start + (stop - start) * rng.random(len(alive)))
            term[alive] *= (pivot - (stop - start) * sigma) / (order * goes_on)
            value[alive] += term[alive]
            cost[alive] += 1
        return Draws(value * np.exp(-pivot) if stop > start else value, cost)
