"""Ray marching behind a random offset: exp(-optical depth) of one comb, which is too large in the mean (Jensen's inequality)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fogproof.contracts import Draws
from fogproof.estimators.tracking.ray_looks import RayLooks
from fogproof.estimators.tracking.unbiased_marching import checked_points
from fogproof.scene import AnyMedium, Ray


@dataclass(frozen=True, eq=False)
class JitteredMarch:
    """exp(-optical depth) along one ray by `points` equidistant looks behind a random offset: biased upwards."""

    medium: AnyMedium
    ray: Ray
    points: int = 4

    def __post_init__(self) -> None:
        checked_points(self.points)

    @cached_property
    def _along(self) -> RayLooks:
        return RayLooks(self.medium, self.ray)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n,), at the cost of their looks."""
        return Draws(np.exp(-self._along.combs(rng, n, self.points)), np.full(n, float(self.points)))
