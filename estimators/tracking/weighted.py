"""Weighted tracking (Galtier et al. 2013): delta tracking whose majorant need not bound the extinction.

A collision is real with probability sigma/(sigma + |m - sigma|), else the walker goes on with the weight (sigma + |m - sigma|)/m,
negative where the null-collision coefficient m - sigma is. Where m bounds sigma all weights are 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fogproof.contracts import Draws
from fogproof.estimators.tracking.ray_looks import RayLooks
from fogproof.scene import AnyMedium, Ray


@dataclass(frozen=True, eq=False)
class WeightedTransmittance:
    """Transmittance along one ray by weighted tracking; `majorant` is the rate m of tentative collisions [1/m], any > 0."""

    medium: AnyMedium
    ray: Ray
    majorant: float | None = None

    @cached_property
    def _along(self) -> RayLooks:
        return RayLooks(self.medium, self.ray)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n,), at the cost of their looks."""
        m = self._along.rate("majorant", self.majorant)
        value, cost = np.ones(n), np.zeros(n)
        for alive, t, sigma in self._along.flights(rng, n, m):
            cost[alive] += 1
            whole = sigma + np.abs(m - sigma)
            real = rng.random(len(alive)) * whole < sigma
            value[alive] = np.where(real, 0.0, value[alive] * np.sign(m - sigma) * whole / m)
            t[alive[real]] = np.inf
        return Draws(value, cost)
