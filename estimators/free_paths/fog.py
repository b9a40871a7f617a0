"""Ambient fog and emission by free paths: the lerp of the lecture, one event at a time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import UnsupportedError
from fogproof.estimators.free_paths.extinction import along
from fogproof.estimators.free_paths.free_path import FreePath, HomogeneousSpectralFreePath, TruncatedFreePath
from fogproof.estimators.media import ROOM
from fogproof.estimators.tracking.medium_data import grey_medium
from fogproof.scene import AnyMedium, Medium, Ray
from fogproof.scene.kinds import given
from fogproof.scene.media import sources_vary
from fogproof.validate import Channels


def everywhere(medium: AnyMedium) -> tuple[float, float]:
    """Return albedo and emission [W/(m^2 sr)] of a grey medium in which they are the same everywhere."""
    grey_medium(medium)
    if sources_vary(medium):
        raise UnsupportedError("albedo and emission must be the same everywhere", "medium")
    return float(np.asarray(medium.albedo)), float(np.asarray(medium.emission))


def source_per_collision(medium: AnyMedium, ambient: float) -> float:
    """Return albedo L_i + (1 - albedo) L_e [W/(m^2 sr)].

    The source sigma_s L_i + sigma_a L_e over sigma_t: what a collision sees, because T / p(t) is 1 / sigma_t there.
    """
    emission = everywhere(medium)[1]
    scattered, absorbed = shares(medium)
    return scattered * ambient + absorbed * emission


def shares(medium: AnyMedium) -> tuple[float, float]:
    """Return sigma_s / sigma_t and sigma_a / sigma_t of a grey medium in which they are the same everywhere."""
    own = given(medium, ROOM, "shares")
    if own is not None:
        found: tuple[float, float] = own(medium)
        return found
    albedo = everywhere(medium)[0]
    return albedo, 1 - albedo


@dataclass(frozen=True, eq=False)
class AnalogFog:
    """Radiance along a ray through a medium in constant in-scattered light.

    medium      grey, with a closed free path and with albedo and emission the same everywhere
    ray         to the background, length inf if there is none
    ambient     L_i [W/(m^2 sr)]
    background  [W/(m^2 sr)]

    A path that collides sees the source over sigma_t, one that reaches the surface the background: T / P(z) is 1.
    """

    medium: AnyMedium
    ray: Ray
    ambient: float
    background: float

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance, each at the cost of one sampled path."""
        length = float(self.ray.length)
        paths = FreePath(along(self.medium, self.ray), length).distances(rng.random((n, 1)))
        at_collision = source_per_collision(self.medium, self.ambient)
        return Draws(np.where(paths == length, self.background, at_collision), cost=np.ones(n))


@dataclass(frozen=True, eq=False)
class HomogeneousSpectralFog:
    """The same in several channels: one free path serves all, see `HomogeneousSpectralFreePath`; the medium is homogeneous."""

    medium: Medium
    ray: Ray
    ambient: Channels
    background: Channels

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, channels) of the radiance, each at the cost of one sampled path."""
        sigma_t = np.asarray(self.medium.sigma_t)
        source = np.multiply(self.medium.sigma_s, self.ambient) + np.multiply(self.medium.sigma_a, self.medium.emission)
        paths = HomogeneousSpectralFreePath(tuple(sigma_t.tolist()), float(self.ray.length)).sample(rng.random((n, 2)))
        assert paths.weight is not None
        assert paths.event is not None
        seen = np.where(paths.event[:, None] == 1, self.background, source)
        return Draws(paths.weight * seen, cost=np.ones(n))


@dataclass(frozen=True, eq=False)
class CertainCollisionFog:
    """The background times T, known in closed form, and one collision that is sure to happen before it.

    The arguments are those of `AnalogFog`, on a ray that ends. What it adds to the closed lerp is the place of the collision: a
    volume term that varies along the ray would be looked up there; here, where it does not, there is no variance.
    """

    medium: AnyMedium
    ray: Ray
    ambient: float
    background: float

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance, each at the cost of one sampled path."""
        extinction = along(self.medium, self.ray)
        through = float(np.exp(-extinction.depth(np.array(float(self.ray.length)))))
        paths = TruncatedFreePath(extinction, float(self.ray.length)).sample(rng.random((n, 1)))
        assert paths.pdf is not None
        source = source_per_collision(self.medium, self.ambient) * extinction.sigma(paths.x)
        arriving = np.exp(-extinction.depth(paths.x)) * source / paths.pdf
        return Draws(through * self.background + arriving, cost=np.ones(n))


@dataclass(frozen=True, eq=False)
class UniformEmission:
    """Radiance that a glowing medium sends along a ray: its emission at a uniform place, attenuated.

    medium         grey, with a closed optical depth and with albedo and emission the same everywhere
    ray            with an end
    times_sigma_a  True: the source is sigma_a L_e; False: the medium's emission is q [W/(m^3 sr)], of itself per volume

    It needs no extinction: gas that glows without absorbing is served too.
    """

    medium: AnyMedium
    ray: Ray
    times_sigma_a: bool = True

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance, each at the cost of one look at the medium."""
        extinction, length = along(self.medium, self.ray), float(self.ray.length)
        t = length * rng.random(n)
        emission = everywhere(self.medium)[1]
        source = emission * shares(self.medium)[1] * extinction.sigma(t) if self.times_sigma_a else emission
        return Draws(length * np.exp(-extinction.depth(t)) * source, cost=np.ones(n))
