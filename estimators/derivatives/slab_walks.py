"""Analog walks through a slab or half space whose path lengths, collisions and scores are kept. Lengths in mean free paths.

The score of a path that leaves is d ln p of all that was drawn on the way: n/c for its n scatterings by the albedo c,
(n - l)/tau for its length l by the thickness, and the sum of d ln f/d g over its deflections by the asymmetry.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import InvalidValueError
from fogproof.estimators.phase.henyey_greenstein import asymmetry_score, cosines
from fogproof.scene import HenyeyGreenstein
from fogproof.validate import number

Side = Literal["reflected", "transmitted"]


class FinishedWalks(NamedTuple):
    """Paths from the surface on.

    side        (n,) -1 reflected, 1 transmitted, 0 absorbed
    length      (n,) inside the slab
    collisions  (n,) scatterings
    score       (n,) sum of d ln f/d g
    """

    side: np.ndarray
    length: np.ndarray
    collisions: np.ndarray
    score: np.ndarray


@dataclass(frozen=True)
class SlabWalk:
    """A beam on a slab.

    albedo  in (0, 1]
    tau     optical thickness > 0, inf for a half space, where the albedo must be below 1
    mu0     cosine of the beam to the normal, in (0, 1]
    g       of Henyey & Greenstein's phase function
    """

    albedo: float
    tau: float
    mu0: float
    g: float = 0.0

    def __post_init__(self) -> None:
        number("albedo", self.albedo, "must lie in (0, 1]", np.nextafter(0, 1), 1)
        if not np.isinf(self.tau):
            number("tau", self.tau, "must be > 0", 0, np.inf, open_ends=True)
        elif self.albedo == 1:
            fix = "in a half space only absorption ends all walks"
            raise InvalidValueError("albedo", "must be below 1 where tau is inf", self.albedo, fix)
        number("mu0", self.mu0, "must lie in (0, 1]", np.nextafter(0, 1), 1)
        number("g", self.g, "must lie in (-1, 1)", -1, 1, open_ends=True)

    def walk(self, rng: np.random.Generator, n: int) -> FinishedWalks:
        """Follow n photons to their ends."""
        side, length, score = np.zeros(n, dtype=int), np.zeros(n), np.zeros(n)
        collisions = np.zeros(n)
        alive, depth, mu = np.arange(n), np.zeros(n), np.full(n, float(self.mu0))
        phase = HenyeyGreenstein(self.g)
        while alive.size:
            flight = rng.standard_exponential(alive.size)
            with np.errstate(divide="ignore", invalid="ignore"):
                wall = np.where(mu > 0, (self.tau - depth) / mu, np.where(mu < 0, -depth / mu, np.inf))
            out = flight >= wall
            length[alive] += np.where(out, wall, flight)
            side[alive[out]] = np.where(mu[out] > 0, 1, -1)
            scatters = ~out & (rng.random(alive.size) < self.albedo)
            alive, depth, mu = alive[scatters], (depth + flight * mu)[scatters], mu[scatters]
            turned = np.empty(alive.size)
            cosines(phase, rng.random(alive.size), turned)
            collisions[alive] += 1
            score[alive] += asymmetry_score(phase, turned)
            around = np.cos(2 * np.pi * rng.random(alive.size))
            mu = np.clip(mu * turned + np.sqrt((1 - mu * mu) * (1 - turned * turned)) * around, -1, 1)
        return FinishedWalks(side, length, collisions, score)

    def leaves(self, walks: FinishedWalks, side: Side) -> np.ndarray:
        """Return which of the walks leave there."""
        return walks.side == (-1 if side == "reflected" else 1)


@dataclass(frozen=True)
class SlabSlopes:
    """Derivatives of what a slab reflects or transmits by albedo, thickness and g: the score of each path that leaves there."""

    beam: SlabWalk
    side: Side = "reflected"

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, 3) of the derivatives by albedo, tau and g."""
        walks = self.beam.walk(rng, n)
        scores = np.stack(
            [walks.collisions / self.beam.albedo, (walks.collisions - walks.length) / self.beam.tau, walks.score],
            axis=1,
        )
        return Draws(np.where(self.beam.leaves(walks, self.side)[:, None], scores, 0.0), walks.collisions)


@dataclass(frozen=True)
class SlabPathLengths:
    """exp(-s l) of what leaves a slab, at several s at once: the transform of its path lengths."""

    beam: SlabWalk
    rates: tuple[float, ...]
    side: Side = "reflected"

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, rates)."""
        walks = self.beam.walk(rng, n)
        value = np.exp(-np.multiply.outer(walks.length, self.rates))
        return Draws(np.where(self.beam.leaves(walks, self.side)[:, None], value, 0.0), walks.collisions)


@dataclass(frozen=True)
class SlabScatteringCounts:
    """Which share of a beam leaves a slab after 0 … `most` scatterings."""

    beam: SlabWalk
    most: int
    side: Side = "reflected"

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, most + 1), of which at most one entry is 1."""
        walks = self.beam.walk(rng, n)
        equal = walks.collisions[:, None] == np.arange(self.most + 1)
        return Draws((equal & self.beam.leaves(walks, self.side)[:, None]).astype(float), walks.collisions)
