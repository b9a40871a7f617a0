"""The next-flight estimator of the transmittance (Cramer 1978; Novák, Selle & Jarosz 2014).

Ratio tracking through the uniform medium that the majorant makes; at its start and at each tentative collision the expected
contribution of the next flight, exp(-m (what is left of the way)), is added with the weight so far. Nothing is scored at the end.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fogproof.contracts import Draws
from fogproof.estimators.tracking.ray_looks import RayLooks
from fogproof.scene import AnyMedium, Ray


@dataclass(frozen=True, eq=False)
class NextFlightTransmittance:
    """Transmittance along one ray by next flights; `majorant` is the rate m of tentative collisions [1/m], any > 0."""

    medium: AnyMedium
    ray: Ray
    majorant: float | None = None

    @cached_property
    def _along(self) -> RayLooks:
        return RayLooks(self.medium, self.ray)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n,), at the cost of their looks."""
        along = self._along
        m = along.rate("majorant", self.majorant)
        stop = along.ends[1]
        value, weight, cost = np.full(n, np.exp(-m * along.length)), np.ones(n), np.zeros(n)
        for alive, t, sigma in along.flights(rng, n, m):
            cost[alive] += 1
            weight[alive] *= 1 - sigma / m
            value[alive] += weight[alive] * np.exp(-m * (stop - t[alive]))
        return Draws(value, cost)
