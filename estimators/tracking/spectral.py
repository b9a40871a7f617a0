"""Null collisions in media of many colours: one path, followed as one channel would, serves all channels with weights.

A path with its fictitious collisions has a known density in each channel, because a majorant common to all makes the free flights
equal: the product of sigma_c / m at the real and 1 - sigma_c / m at the fictitious collisions. The channel that decides is drawn
uniformly, and a path's weight in channel c is its density there over the mean density (balance heuristic, Wilkie et al. 2014; in
null-collision media Miller et al. 2019, after Kutz et al. 2017): at most the number of channels.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np

from fogproof.contracts import Draw, Draws
from fogproof.domains import HalfLine, Interval
from fogproof.errors import UnsupportedError
from fogproof.estimators.tracking.majorant_grid import MajorantGrid
from fogproof.estimators.tracking.optical_depth import optical_depth, path_density
from fogproof.estimators.tracking.tracked import Tracked, run, single, track
from fogproof.scene import AnyMedium, Ray
from fogproof.validate import Channels, nonnegative_channels


class SpectralFlights(NamedTuple):
    """Where paths end, and their weights in all channels.

    distance  (n,) [m]
    event     (n,) 0 at a collision, 1 at the end of the ray
    weight    (n, channels), in [0, channels]
    cost      (n,) look-ups of the medium, all channels at once
    """

    distance: np.ndarray
    event: np.ndarray
    weight: np.ndarray
    cost: np.ndarray


def spectral_tracking(
    medium: AnyMedium, rays: Ray, rng: np.random.Generator, majorant: float | MajorantGrid | None = None
) -> SpectralFlights:
    """Return one flight along each ray of a flattened batch.

    medium    any that kernels know: homogeneous, linear, exponential, layered, voxels, or procedural with a CompiledField
    majorant  bound of sigma_t over all channels [1/m]: a number, in blocks, or None for the medium's own
    """
    return _fly(_track(medium, rays, majorant), rng, rays.length.size)


def _track(medium: AnyMedium, rays: Ray, majorant: float | MajorantGrid | None) -> Tracked:
    tracked = track(medium, rays, majorant)
    if tracked.data is None:
        fix = "wrap a numba function f(x, y, z, channel) in CompiledField"
        raise UnsupportedError(f"spectral tracking needs a compiled medium, not a Python function; {fix}", "medium")
    return tracked


def _fly(tracked: Tracked, rng: np.random.Generator, n: int) -> SpectralFlights:
    from fogproof.estimators.kernels import tracking as kernel_tracking

    flights = SpectralFlights(np.empty(n), np.empty(n, np.int64), np.empty((n, tracked.channels)), np.empty(n))
    run(kernel_tracking.spectral_tracking, tracked, rng, *flights)
    return flights


@dataclass(frozen=True, eq=False)
class SpectralFreePath:
    """Distance to the first collision along one ray, drawn from the mean of the channels' densities, with weights.

    The arguments are those of `spectral_tracking`. The weights of a `Draw` belong to the whole path: given the distance, their
    mean is sigma_c T_c over the density.
    """

    medium: AnyMedium
    ray: Ray
    majorant: float | MajorantGrid | None = None
    dimensions: ClassVar[None] = None

    @cached_property
    def _tracked(self) -> Tracked:
        return _track(self.medium, single(self.ray), self.majorant)

    @property
    def domain(self) -> Interval | HalfLine:
        """[0, length], or the half line."""
        length = float(self.ray.length)
        return HalfLine(0.0) if np.isinf(length) else Interval(0.0, length)

    @cached_property
    def atoms(self) -> dict[float, float]:
        """The probability of reaching the end of the ray: the mean over channels of T."""
        length = float(self.ray.length)
        return {length: float(np.exp(-optical_depth(self.medium, self.ray, np.array([length]))).mean())}

    def sample(self, rng: np.random.Generator, n: int) -> Draw:
        """Return n distances [m] with their weights (n, channels); event 0 is a collision, 1 the end of the ray."""
        flights = _fly(self._tracked, rng, n)
        return Draw(flights.distance, weight=flights.weight, event=flights.event)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of collisions at distances x (n,), the mean over channels of sigma_t T [1/m]."""
        return path_density(self.medium, self.ray, x).mean(axis=-1)


@dataclass(frozen=True, eq=False)
class SpectralFog:
    """Radiance along one ray through a medium of many colours in constant in-scattered light, by spectral tracking.

    medium      with channels; albedo constant in space
    ambient     L_i [W/(m^2 sr)], () or (channels,)
    background  radiance at the end of the ray [W/(m^2 sr)], () or (channels,)
    majorant    as in `spectral_tracking`

    A path that collides sees albedo L_i, one that reaches the end the background, both times its weights. With an ambient of 0
    and a background of 1 it estimates the transmittance.
    """

    medium: AnyMedium
    ray: Ray
    ambient: Channels
    background: Channels
    majorant: float | MajorantGrid | None = None

    @cached_property
    def _tracked(self) -> Tracked:
        return _track(self.medium, single(self.ray), self.majorant)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, channels), at the cost of their look-ups."""
        flights = _fly(self._tracked, rng, n)
        ambient = np.asarray(nonnegative_channels("ambient", self.ambient, "W/(m^2 sr)"))
        background = np.asarray(nonnegative_channels("background", self.background, "W/(m^2 sr)"))
        albedo = self.medium.albedo
        if callable(albedo) or np.ndim(albedo) > 1:
            raise UnsupportedError("SpectralFog needs an albedo that is constant in space", "albedo")
        seen = np.where(flights.event[:, None] == 1, background, np.asarray(albedo) * ambient)
        return Draws(flights.weight * seen, flights.cost)
