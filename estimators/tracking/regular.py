"""Regular tracking through a voxel grid: every cell on the way, in order (Amanatides & Woo 1987), each in closed form.

In a voxel of constant extinction the optical depth grows linearly; between the centres of eight voxels a trilinear extinction is
a cubic along the ray and the optical depth a quartic, inverted by a safeguarded Newton method. Nothing is random but the depth
at which a path collides.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np

from fogproof.contracts import Draw, Draws
from fogproof.domains import HalfLine, Interval
from fogproof.errors import UnsupportedError
from fogproof.estimators.media import ROOM
from fogproof.estimators.tracking.medium_data import grey_medium, look_ups
from fogproof.estimators.tracking.tracked import single
from fogproof.scene import AnyMedium, Ray, VoxelGrid
from fogproof.scene.kinds import given


class Walks(NamedTuple):
    """What walks through a grid met, (n,) each.

    distance  where the wanted optical depth is reached, or the length of the ray [m]
    tau       optical depth there
    cells     how many cells were looked at
    """

    distance: np.ndarray
    tau: np.ndarray
    cells: np.ndarray


def regular_tracking(grid: VoxelGrid, rays: Ray, depth: np.ndarray | float = np.inf, channel: int = 0) -> Walks:
    """Walk along rays until an optical depth is reached, or to their ends.

    depth    () or (n,): n walks along one ray, or one along each of n rays
    channel  which one of the grid's channels

    The optical depth is exact but for rounding, a few EPS of it however many cells there are.
    """
    walk = _walk_of(grid)
    origin, direction = (np.array(a.reshape(-1, 3), order="C") for a in (rays.origin, rays.direction))
    length = np.array(rays.length.reshape(-1))
    depth = np.array(np.broadcast_to(depth, length.shape) if np.ndim(depth) == 0 else depth, dtype=np.float64)
    walks = Walks(*(np.empty(depth.shape) for _ in range(3)))
    walk(grid, origin, direction, length, depth, channel, *walks)
    return walks


def _walk_of(medium: AnyMedium) -> Any:
    """Return the walk through the cells of a medium, or say that it has none."""
    walk = given(medium, ROOM, "walk")
    if walk is None:
        raise UnsupportedError(f"regular tracking needs a VoxelGrid, got {type(medium).__name__}", "medium")
    return walk


@dataclass(frozen=True, eq=False)
class RegularTransmittance:
    """Transmittance through a grid along one ray, without variance."""

    medium: VoxelGrid
    ray: Ray

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n times the same value, (n,) or (n, channels), at the cost of the cells met."""
        _walk_of(self.medium)
        walks = [regular_tracking(self.medium, single(self.ray), channel=c) for c in range(self.medium.channels or 1)]
        value = np.exp(-np.array([walk.tau[0] for walk in walks]))
        value = value if self.medium.channels else value[0]
        return Draws(np.broadcast_to(value, (n, *np.shape(value))), np.full(n, walks[0].cells[0]))


@dataclass(frozen=True, eq=False)
class RegularFreePath:
    """Distance to the first collision in a grid along one ray, or to its end, where the atom has the probability T.

    One uniform a sample; a pure function of it.
    """

    medium: VoxelGrid
    ray: Ray
    dimensions: ClassVar[int] = 1

    def __post_init__(self) -> None:
        _walk_of(self.medium)
        grey_medium(self.medium)
        single(self.ray)

    @property
    def domain(self) -> Interval | HalfLine:
        """[0, length], or the half line."""
        length = float(self.ray.length)
        return HalfLine(0.0) if np.isinf(length) else Interval(0.0, length)

    @cached_property
    def atoms(self) -> dict[float, float]:
        """The probability of reaching the end of the ray."""
        return {float(self.ray.length): float(np.exp(-regular_tracking(self.medium, self.ray).tau[0]))}

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to distances [m], with their density [1/m], or probability at the end of the ray."""
        depth = -np.log1p(-u[:, 0])
        walks = regular_tracking(self.medium, self.ray, depth)
        missed = walks.tau < depth
        through = np.exp(-walks.tau)
        pdf = np.where(missed, through, self._sigma(np.where(missed, 0.0, walks.distance)) * through)
        return Draw(walks.distance, pdf, event=missed.astype(np.int64))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of collisions sigma_t T at distances x (n,) [1/m]."""
        rays = Ray(self.ray.origin, self.ray.direction, np.maximum(x, np.finfo(float).tiny))
        return self._sigma(x) * np.exp(-regular_tracking(self.medium, rays).tau)

    def _sigma(self, t: np.ndarray) -> np.ndarray:
        x = self.ray.origin + t[:, None] * self.ray.direction
        inside = np.all((x >= self.medium.lower) & (x <= self.medium.upper), axis=-1)
        return np.where(inside, look_ups(self.medium)(x, x)[:, 0], 0.0)
