"""Derivatives of the transmittance of plane layers, by the score of free paths and by ratio tracking.

The score-function estimator multiplies what was drawn by d ln p: it needs no derivative of the value. Attached sampling keeps
the random numbers and differentiates the weight.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import InvalidValueError
from fogproof.validate import number


@dataclass(frozen=True)
class FreePathScore:
    """dT/d sigma_t of a homogeneous segment: a free path t passes with probability exp(-sigma_t s), whose score is -s.

    sigma_t  extinction coefficient [1/m], > 0
    length   s [m]
    """

    sigma_t: float
    length: float

    def __post_init__(self) -> None:
        number("sigma_t", self.sigma_t, "must be finite and > 0 [1/m]", 0, np.inf, open_ends=True)
        number("length", self.length, "must be finite and >= 0 [m]", 0)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n,) [m]."""
        passes = rng.standard_exponential(n) > self.sigma_t * self.length
        return Draws(np.where(passes, -self.length, 0.0))


@dataclass(frozen=True)
class RatioTrackingSlopes:
    """dT/d sigma_i of every layer that a ray crosses, by ratio tracking under a majorant that stays where it is.

    T is the mean of prod_k (1 - sigma(x_k)/majorant) over the tentative collisions (Novak et al. 2014); each of those in
    layer i adds the product of the others times -1/majorant.

    sigma_t   of each layer [1/m]
    lengths   the ray's length in each of them [m]
    majorant  above every sigma_t [1/m]
    """

    sigma_t: tuple[float, ...]
    lengths: tuple[float, ...]
    majorant: float

    def __post_init__(self) -> None:
        if len(self.sigma_t) != len(self.lengths):
            raise InvalidValueError("lengths", f"must be one for each of {len(self.sigma_t)} layers", self.lengths)
        number("majorant", self.majorant, "must be above every sigma_t", max(self.sigma_t), np.inf, open_ends=True)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, layers) [m]; their cost is the number of tentative collisions."""
        ends = np.cumsum(self.lengths)
        count = rng.poisson(self.majorant * ends[-1], n)
        slots = np.arange(count.max(initial=0))
        x = ends[-1] * rng.random((n, slots.size))
        layer = np.minimum(np.searchsorted(ends, x, side="right"), len(ends) - 1)
        there = slots < count[:, None]
        factor = np.where(there, 1 - np.asarray(self.sigma_t)[layer] / self.majorant, 1.0)
        one_less = np.prod(factor, axis=1, keepdims=True) / factor * np.where(there, -1 / self.majorant, 0.0)
        value = np.stack([np.sum(np.where(layer == i, one_less, 0.0), axis=1) for i in range(len(ends))], axis=1)
        return Draws(value, count.astype(float))
