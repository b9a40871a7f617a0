"""Decomposition tracking (Kutz et al. 2017): a control part of the extinction in closed form, the rest by delta tracking.

A path passes if it passes both parts. The control part c is everywhere, and its transmittance exp(-c s) a factor; collisions with
what is left, sigma - c, end the path. Look-ups are those of the rest, under its own majorant.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import InvalidValueError
from fogproof.estimators.tracking.ray_looks import RayLooks
from fogproof.scene import AnyMedium, Ray
from fogproof.validate import number


@dataclass(frozen=True, eq=False)
class DecompositionTransmittance:
    """Transmittance along one ray by decomposition tracking.

    control   c, a lower bound of the extinction wherever the medium's box is [1/m]
    majorant  of the whole extinction [1/m]; None for the least that is known
    """

    medium: AnyMedium
    ray: Ray
    control: float
    majorant: float | None = None

    def __post_init__(self) -> None:
        number("control", self.control, "must be finite and >= 0 [1/m]", 0)

    @cached_property
    def _along(self) -> RayLooks:
        return RayLooks(self.medium, self.ray)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n,), at the cost of their looks."""
        along, c = self._along, self.control
        m = along.rate("majorant", self.majorant) - c
        if m < 0:
            raise InvalidValueError("control", f"must not exceed the majorant {m + c:g} [1/m]", c)
        value, cost = np.full(n, np.exp(-c * along.length)), np.zeros(n)
        for alive, t, sigma in along.flights(rng, n, m):
            cost[alive] += 1
            bad = (sigma < c) | (sigma > (m + c) * (1 + 1e-9))
            if bad.any():
                rule = f"must lie below the extinction, and the majorant {m + c:g} above it"
                raise InvalidValueError("control", rule, c, f"sigma_t = {sigma[bad][0]:g} [1/m] was met")
            real = rng.random(len(alive)) * m < sigma - c
            value[alive[real]], t[alive[real]] = 0.0, np.inf
        return Draws(value, cost)
