"""Delta tracking (Woodcock et al. 1965): fictitious matter makes the medium uniform, and collisions with it are taken back.

Exact for any medium under a majorant; a loose majorant costs look-ups and nothing else. Expected look-ups are the integral of
majorant times transmittance.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np

from fogproof.contracts import Draw, Draws
from fogproof.domains import HalfLine, Interval
from fogproof.estimators.tracking.majorant_grid import MajorantGrid
from fogproof.estimators.tracking.medium_data import grey_medium
from fogproof.estimators.tracking.optical_depth import optical_depth, path_density
from fogproof.estimators.tracking.tracked import Tracked, run, single, track
from fogproof.estimators.tracking.wavefront import delta_wavefront
from fogproof.scene import AnyMedium, Ray


class Flights(NamedTuple):
    """Where paths end.

    distance  [m]
    event     0 at a collision, 1 at the end of the ray
    cost      look-ups of the medium
    """

    distance: np.ndarray
    event: np.ndarray
    cost: np.ndarray


def delta_tracking(
    medium: AnyMedium, rays: Ray, rng: np.random.Generator, majorant: float | MajorantGrid | None = None
) -> Flights:
    """Return one flight along each ray of a batch, in its shape.

    medium    grey: homogeneous, linear, exponential, layered, voxels or procedural
    majorant  bound of sigma_t [1/m]: a number, in blocks, or None for the medium's own; look-ups above it raise
    """
    flights = _fly(track(grey_medium(medium), rays, majorant), rng, rays.length.size)
    return Flights(*(part.reshape(rays.shape) for part in flights))


def _fly(tracked: Tracked, rng: np.random.Generator, n: int) -> Flights:
    if tracked.data is None:
        return Flights(*delta_wavefront(tracked, rng, n))
    from fogproof.estimators.kernels import tracking as kernel_tracking

    flights = Flights(np.empty(n), np.empty(n, np.int64), np.empty(n))
    run(kernel_tracking.delta_tracking, tracked, rng, *flights)
    return flights


@dataclass(frozen=True, eq=False)
class DeltaFreePath:
    """Distance to the first collision along one ray, or to its end, where the atom has the probability T.

    The arguments are those of `delta_tracking`. It consumes a varying number of uniforms: `sample(rng, n)`.
    """

    medium: AnyMedium
    ray: Ray
    majorant: float | MajorantGrid | None = None
    dimensions: ClassVar[None] = None

    @cached_property
    def _tracked(self) -> Tracked:
        return track(grey_medium(self.medium), single(self.ray), self.majorant)

    @property
    def domain(self) -> Interval | HalfLine:
        """[0, length], or the half line."""
        length = float(self.ray.length)
        return HalfLine(0.0) if np.isinf(length) else Interval(0.0, length)

    @cached_property
    def atoms(self) -> dict[float, float]:
        """The probability of reaching the end of the ray."""
        length = float(self.ray.length)
        return {length: float(np.exp(-optical_depth(self.medium, self.ray, np.array([length]))[0, 0]))}

    def sample(self, rng: np.random.Generator, n: int) -> Draw:
        """Return n distances [m]; event 0 is a collision, 1 the end of the ray."""
        flights = _fly(self._tracked, rng, n)
        return Draw(flights.distance, event=flights.event)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of collisions sigma_t T at distances x (n,) [1/m]."""
        return path_density(self.medium, self.ray, x)[:, 0]


@dataclass(frozen=True, eq=False)
class DeltaTransmittance:
    """1 if a path reaches the end of the ray, 0 if it collides; the mean is T and the variance T (1 - T).

    The arguments are those of `delta_tracking`, for one ray.
    """

    medium: AnyMedium
    ray: Ray
    majorant: float | MajorantGrid | None = None

    @cached_property
    def _tracked(self) -> Tracked:
        return track(grey_medium(self.medium), single(self.ray), self.majorant)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations, at the cost of their look-ups."""
        flights = _fly(self._tracked, rng, n)
        return Draws(flights.event.astype(np.float64), flights.cost)
