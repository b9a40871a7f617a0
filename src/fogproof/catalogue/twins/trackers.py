"""Trackers with planted errors, written out plainly: each argument is a place where something can go wrong, and has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.contracts import Draws, Sampler
from fogproof.domains import Domain
from fogproof.estimators.tracking.medium_data import look_ups
from fogproof.scene import AnyMedium, Ray

Steps = Callable[[np.random.Generator, int], np.ndarray]
Factor = Callable[[np.ndarray, float], np.ndarray]


def exponential(rng: np.random.Generator, n: int) -> np.ndarray:
    """Return free flights in units of 1 / majorant, as they should be."""
    return rng.standard_exponential(n)


def decimal(rng: np.random.Generator, n: int) -> np.ndarray:
    """Return free flights by the decimal logarithm."""
    return -np.log10(1 - rng.random(n))


def ratio(sigma: np.ndarray, majorant: float) -> np.ndarray:
    """Return the factor of a tentative collision, as it should be."""
    return 1 - sigma / majorant


@dataclass(frozen=True, eq=False)
class LiteralTracker:
    """Delta and ratio tracking of one grey medium along one ray inside it.

    majorant   nobody looks whether it bounds the extinction
    steps      free flights
    factor     of the weight at a tentative collision
    certain    every tentative collision is taken for a real one
    from_start each flight is counted from the start of the ray, not from where the last one ended
    once       tracking ends after the first tentative collision
    """

    medium: AnyMedium
    ray: Ray
    majorant: float
    steps: Steps = exponential
    factor: Factor = ratio
    certain: bool = False
    from_start: bool = False
    once: bool = False

    def fly(self, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return where paths end by delta tracking, the weights by ratio tracking of the same flights, and look-ups."""
        look = look_ups(self.medium)
        length = float(self.ray.length)
        t, end, weight, cost = np.zeros(n), np.full(n, length), np.ones(n), np.zeros(n)
        alive, flying = np.arange(n), np.ones(n, bool)
        while len(alive):
            step = self.steps(rng, len(alive)) / self.majorant
            t[alive] = step if self.from_start else t[alive] + step
            alive = alive[t[alive] < length]
            if not len(alive):
                break
            x = self.ray.origin + t[alive, None] * self.ray.direction
            sigma = look(x, np.broadcast_to(self.ray.direction, x.shape))[:, 0]
            cost[alive] += 1
            weight[alive] *= self.factor(sigma, self.majorant)
            real = np.ones(len(alive), bool) if self.certain else rng.random(len(alive)) * self.majorant < sigma
            first = alive[real & flying[alive]]
            end[first], flying[first] = t[first], False
            if self.once:
                break
            if self.from_start:
                alive = alive[flying[alive]]
        return end, weight, cost

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return weights by ratio tracking."""
        _, weight, cost = self.fly(rng, n)
        return Draws(weight, cost)


@dataclass(frozen=True, eq=False)
class LiteralDelta:
    """1 where a path of the tracker reaches the end of the ray."""

    tracker: LiteralTracker

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return hits and misses."""
        end, _, cost = self.tracker.fly(rng, n)
        return Draws((end == float(self.tracker.ray.length)).astype(np.float64), cost)


@dataclass(frozen=True, eq=False)
class OtherSamples:
    """A sampler that claims what the original claims and samples something else."""

    original: Sampler
    sample: Callable[..., Any]

    @property
    def domain(self) -> Domain:
        """The original's domain."""
        return self.original.domain

    @property
    def dimensions(self) -> int | None:
        """The original's number of uniforms."""
        return self.original.dimensions

    @property
    def atoms(self) -> Any:
        """The original's atoms."""
        return getattr(self.original, "atoms", {})

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the original's density."""
        return self.original.pdf(x)
