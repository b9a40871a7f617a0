"""Analog walks through a ball under a uniform sky whose path lengths are kept. Lengths in mean free paths."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.contracts import Draws
from fogproof.validate import number


@dataclass(frozen=True)
class BallPathLengths:
    """exp(-s l) of what leaves a ball that scatters isotropically, at several s at once.

    albedo  in [0, 1]
    radius  > 0
    rates   s, per mean free path
    """

    albedo: float
    radius: float
    rates: tuple[float, ...]

    def __post_init__(self) -> None:
        number("albedo", self.albedo, "must lie in [0, 1]", 0, 1)
        number("radius", self.radius, "must be finite and > 0", 0, np.inf, open_ends=True)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, rates)."""
        left, length = self.lengths(rng, n)
        return Draws(np.where(left[:, None], np.exp(-np.multiply.outer(length, self.rates)), 0.0))

    def lengths(self, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Return which of n photons leave, and how far they have gone by then.

        Of the place only the distance r from the centre counts, of the direction its cosine to the radius.
        """
        left, length = np.zeros(n, dtype=bool), np.zeros(n)
        alive, r, mu = np.arange(n), np.full(n, float(self.radius)), -np.sqrt(rng.random(n))
        while alive.size:
            flight = rng.standard_exponential(alive.size)
            chord = np.sqrt(np.maximum(self.radius**2 - r * r * (1 - mu * mu), 0.0)) - r * mu
            out = flight >= chord
            length[alive] += np.where(out, chord, flight)
            left[alive[out]] = True
            scatters = ~out & (rng.random(alive.size) < self.albedo)
            t, r, mu, alive = flight[scatters], r[scatters], mu[scatters], alive[scatters]
            r = np.sqrt(np.maximum(r * r + t * t + 2 * r * t * mu, 0.0))
            mu = 2 * rng.random(alive.size) - 1
        return left, length
