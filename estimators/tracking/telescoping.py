"""Transmittance by a telescoping sum of marches, each twice as fine (Misso, Bitterli, Georgiev & Jarosz 2022).

exp(-tau) is the limit of what marching finds with M, 2 M, 4 M, … looks, hence the first plus all differences: one of them, drawn
at random and divided by its probability, debiases the first. A difference is of two combs with the same random offset, so that it
shrinks with the step, by more than its probability does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fogproof.contracts import Draws
from fogproof.estimators.tracking.ray_looks import RayLooks
from fogproof.estimators.tracking.unbiased_marching import BLOCK, checked_points
from fogproof.scene import AnyMedium, Ray
from fogproof.validate import number

FINEST = 20
"""Halving after which a difference is below rounding; it is drawn once in 10^9."""


@dataclass(frozen=True, eq=False)
class TelescopingTransmittance:
    """Transmittance along one ray by a telescoping sum of marches.

    points  M, looks of the coarsest comb
    ratio   of the probabilities of one difference and the one before it: between 1/4, where the variance of media with jumps
            becomes infinite, and 1/2, where the mean cost does
    """

    medium: AnyMedium
    ray: Ray
    points: int = 4
    ratio: float = 0.35

    def __post_init__(self) -> None:
        checked_points(self.points)
        number("ratio", self.ratio, "must lie in the open interval (1/4, 1/2)", 0.25, 0.5, open_ends=True)

    @cached_property
    def _along(self) -> RayLooks:
        return RayLooks(self.medium, self.ray)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n,), at the cost of their looks."""
        along, M = self._along, self.points
        levels = np.minimum(np.floor(np.log1p(-rng.random(n)) / math.log(self.ratio)), FINEST).astype(int)
        offset = rng.random(n)
        value, cost = np.empty(n), np.empty(n)
        for level in np.unique(levels):
            (which,) = np.nonzero(levels == level)
            coarse, fine = M << int(level), M << int(level) + 1
            chance = (1 - self.ratio) * self.ratio**level if level < FINEST else self.ratio**level
            for some in np.array_split(which, math.ceil(len(which) * fine / BLOCK) or 1):
                first, low, high = (np.exp(-along.depth(offset[some], m)) for m in (M, coarse, fine))
                value[some] = first + (high - low) / chance
            cost[which] = coarse + fine + (M if level else 0)
        return Draws(value, cost)
