"""Ratio and residual ratio tracking (Novák et al. 2014): the transmittance as a product over tentative collisions.

Instead of ending the path with probability sigma / m at a tentative collision, its weight is multiplied by 1 - sigma / m. With a
control extinction c, whose transmittance is known in closed form, only the residual is tracked: factors 1 - (sigma - c) / m with
a majorant m of |sigma - c|. The variance is T^2 (exp(integral of (sigma - c)^2 / m) - 1), expected look-ups the integral of m.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from fogproof.contracts import Draws
from fogproof.estimators.majorant_grid import MajorantGrid
from fogproof.estimators.tracked import Tracked, run, single, track
from fogproof.estimators.wavefront import ratio_wavefront
from fogproof.scene import AnyMedium, Ray


def ratio_tracking(
    medium: AnyMedium,
    rays: Ray,
    rng: np.random.Generator,
    majorant: float | MajorantGrid | None = None,
    control: float | Literal["middle"] = 0.0,
) -> Draws:
    """Return one estimate of the transmittance along each ray of a batch, in its shape, then (channels,) if there are any.

    medium    homogeneous, linear, exponential, layered, voxels or procedural; all channels are tracked together
    majorant  bound of sigma_t [1/m]: a number, in blocks, or None for the medium's own; look-ups above it raise
    control   extinction handled in closed form [1/m]; "middle": half-way between the known bounds, which may differ from
              block to block; 0 is ratio tracking
    """
    draws = _estimate(track(medium, rays, majorant, control), rng, rays.length.size)
    channels = () if medium.channels is None else (medium.channels,)
    return Draws(draws.value.reshape(rays.shape + channels), np.asarray(draws.cost).reshape(rays.shape))


def _estimate(tracked: Tracked, rng: np.random.Generator, n: int) -> Draws:
    if tracked.data is None:
        return Draws(*ratio_wavefront(tracked, rng, n))
    from fogproof.estimators import kernel_tracking

    value, cost = np.empty((n, tracked.channels)), np.empty(n)
    run(kernel_tracking.ratio_tracking, tracked, rng, value, cost)
    return Draws(value, cost)


@dataclass(frozen=True, eq=False)
class RatioTransmittance:
    """Transmittance along one ray by ratio tracking; the arguments are those of `ratio_tracking`."""

    medium: AnyMedium
    ray: Ray
    majorant: float | MajorantGrid | None = None

    @cached_property
    def _tracked(self) -> Tracked:
        return track(self.medium, single(self.ray), self.majorant)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations, (n,) or (n, channels), at the cost of their look-ups."""
        draws = _estimate(self._tracked, rng, n)
        return draws if self.medium.channels else Draws(draws.value[:, 0], draws.cost)


@dataclass(frozen=True, eq=False)
class ResidualRatioTransmittance:
    """Transmittance along one ray by residual ratio tracking; the arguments are those of `ratio_tracking`."""

    medium: AnyMedium
    ray: Ray
    majorant: float | MajorantGrid | None = None
    control: float | Literal["middle"] = "middle"

    @cached_property
    def _tracked(self) -> Tracked:
        return track(self.medium, single(self.ray), self.majorant, self.control)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations, (n,) or (n, channels), at the cost of their look-ups."""
        draws = _estimate(self._tracked, rng, n)
        return draws if self.medium.channels else Draws(draws.value[:, 0], draws.cost)
