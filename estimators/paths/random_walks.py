"""Analog random walks: photons that fly, collide and turn, counted rather than gathered."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators.kernels.path_data import PathRules, PathScene
from fogproof.estimators.media import ROOM
from fogproof.estimators.paths import data as path_data
from fogproof.estimators.paths.tracer import ENDLESS, trace, whole
from fogproof.estimators.phase.functions import kernel_lobe
from fogproof.estimators.tracking.majorant_grid import MajorantGrid
from fogproof.scene import AnyMedium, Isotropic, PhaseFunction
from fogproof.scene.kinds import given
from fogproof.scene.shapes import Shape
from fogproof.validate import number


@dataclass(frozen=True)
class RandomFlights:
    """Displacement along the first direction, and its square, after `flights` flights, in mean free paths."""

    flights: int
    phase: PhaseFunction = field(default_factory=Isotropic)

    def __post_init__(self) -> None:
        whole("flights", self.flights, 0)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, 2), columns z and r^2."""
        from fogproof.estimators.kernels.walks import displacements

        moved = np.empty((n, 3))
        displacements(rng, kernel_lobe(self.phase), self.flights, moved)
        return Draws(np.stack([moved[:, 2], np.sum(moved * moved, axis=1)], axis=1), np.full(n, float(self.flights)))


@dataclass(frozen=True)
class PointSourceWalks:
    """Collisions of photons from a point source within balls about it.

    albedo  below 1, or walks never end
    radii   of the balls, in mean free paths
    """

    albedo: float
    radii: tuple[float, ...]
    phase: PhaseFunction = field(default_factory=Isotropic)

    def __post_init__(self) -> None:
        if not number("albedo", self.albedo, "must lie in [0, 1)", 0, 1) < 1:
            fix = "in an infinite medium only absorption ends a walk"
            raise InvalidValueError("albedo", "must lie in [0, 1)", self.albedo, fix)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the counts (n, balls)."""
        from fogproof.estimators.kernels.walks import collisions_within

        count = np.empty((n, len(self.radii)))
        collisions_within(rng, kernel_lobe(self.phase), self.albedo, np.array(self.radii, dtype=float), count)
        return Draws(count)


@dataclass(frozen=True)
class RodWalks:
    """What comes back from a rod and what passes it, in one dimension.

    albedo  share of the collisions that scatter, in [0, 1]
    length  of the rod, in mean free paths
    g       mean cosine: a share (1 + g)/2 goes on forwards
    """

    albedo: float
    length: float
    g: float = 0.0

    def __post_init__(self) -> None:
        number("albedo", self.albedo, "must lie in [0, 1]", 0, 1)
        number("length", self.length, "must be finite and >= 0", 0)
        number("g", self.g, "must lie in [-1, 1]", -1, 1)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, 2), columns back and through."""
        from fogproof.estimators.kernels.walks import along_rod

        left, collisions = np.empty((n, 2)), np.empty(n)
        along_rod(rng, float(self.albedo), float(self.length), 0.5 * (1.0 + self.g), left, collisions)
        return Draws(left, collisions)


@dataclass(frozen=True, eq=False)
class ScatteringsUnderUniformSky:
    """How often light of a uniform sky scatters in a body that absorbs nothing, by rays that enter anywhere.

    medium    fills `shape`; its absorption is left out
    shape     slab, ball or box
    majorant  as in `PathTracer`
    """

    medium: AnyMedium
    shape: Shape
    majorant: float | MajorantGrid | None = None

    @cached_property
    def _scene(self) -> PathScene:
        rules = PathRules(1.0, 0.0, 1.0, False, True, ENDLESS, -1.0, ENDLESS, 1.0, ENDLESS)
        scattering = given(self.medium, ROOM, "without_absorption")
        medium = self.medium if scattering is None else scattering(self.medium)
        data, bound = path_data.medium_and_bound(medium, self.shape, self.majorant)
        lobe = kernel_lobe(self.medium.phase)
        region = path_data.region(self.shape)
        return PathScene(data, bound, region, lobe, path_data.lamp(None), path_data.wall(None), rules)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the number of scatterings (n,)."""
        point, normal = entrances(self.shape, rng, n)
        paths = trace(self._scene, point, _inwards(normal, rng), rng, n, 1)
        return Draws(paths.scatterings.astype(np.float64), paths.cost)


def entrances(shape: Shape, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points uniform on the boundary of a shape and the normals out of it there, (n, 3) each."""
    draw = given(shape, "fogproof.estimators.shapes", "entrances")
    if draw is None:
        raise UnsupportedError(f"rays enter a slab, a ball or a box, got {type(shape).__name__}", "shape")
    point, normal = draw(shape, rng, n)
    return point, normal


def _inwards(normal: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return directions into the shape with density cos / pi about the normals (n, 3)."""
    w = rng.standard_normal(normal.shape)
    w = w / np.linalg.norm(w, axis=1, keepdims=True) - normal
    return w / np.linalg.norm(w, axis=1, keepdims=True)
