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
from fogproof.estimators.tracking.majorant_grid import MajorantGrid
from fogproof.estimators.tracking.tracked import Tracked, require_fewer_look_ups, run, single, track
from fogproof.estimators.tracking.wavefront import ratio_wavefront
from fogproof.scene import AnyMedium, Ray

Majorant = float | MajorantGrid | None
Control = float | Literal["low", "middle"]

MOST_LOOK_UPS = 1e9
"""Of one realisation: it looks at every tentative collision on the way."""


def ratio_tracking(
    medium: AnyMedium,
    rays: Ray,
    rng: np.random.Generator,
    majorant: Majorant = None,
    control: Control = 0.0,
) -> Draws:
    """Return one estimate of the transmittance along each ray of a batch, in its shape, then (channels,) if there are any.

    medium    homogeneous, linear, exponential, layered, voxels or procedural; all channels are tracked together
    majorant  bound of sigma_t [1/m]: a number, in blocks, or None for the medium's own; look-ups above it raise
    control   extinction handled in closed form [1/m]: a number, or piece by piece the "low" bound that is known, which keeps
              weights in [0, 1], or the "middle" between both bounds, which halves the look-ups, but has weights up to 2 at each;
              0 is ratio tracking
    """
    draws = _estimate(_track(medium, rays, majorant, control), rng, rays.length.size)
    channels = () if medium.channels is None else (medium.channels,)
    return Draws(draws.value.reshape(rays.shape + channels), np.asarray(draws.cost).reshape(rays.shape))


def _track(medium: AnyMedium, rays: Ray, majorant: Majorant, control: Control = 0.0) -> Tracked:
    tracked = track(medium, rays, majorant, control)
    require_fewer_look_ups(tracked, medium, MOST_LOOK_UPS)
    return tracked


def _estimate(tracked: Tracked, rng: np.random.Generator, n: int) -> Draws:
    if tracked.data is None:
        return Draws(*ratio_wavefront(tracked, rng, n))
    from fogproof.estimators.kernels import tracking as kernel_tracking

    value, cost = np.empty((n, tracked.channels)), np.empty(n)
    run(kernel_tracking.ratio_tracking, tracked, rng, value, cost)
    return Draws(value, cost)


@dataclass(frozen=True, eq=False)
class RatioTransmittance:
    """Transmittance along one ray by ratio tracking; the arguments are those of `ratio_tracking`."""

    medium: AnyMedium
    ray: Ray
    majorant: Majorant = None

    @cached_property
    def _tracked(self) -> Tracked:
        return _track(self.medium, single(self.ray), self.majorant)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations, (n,) or (n, channels), at the cost of their look-ups."""
        draws = _estimate(self._tracked, rng, n)
        return draws if self.medium.channels else Draws(draws.value[:, 0], draws.cost)


@dataclass(frozen=True, eq=False)
class ResidualRatioTransmittance:
    """Transmittance along one ray by residual ratio tracking; the arguments are those of `ratio_tracking`."""

    medium: AnyMedium
    ray: Ray
    majorant: Majorant = None
    control: Control = "low"

    @cached_property
    def _tracked(self) -> Tracked:
        return _track(self.medium, single(self.ray), self.majorant, self.control)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations, (n,) or (n, channels), at the cost of their look-ups."""
        draws = _estimate(self._tracked, rng, n)
        return draws if self.medium.channels else Draws(draws.value[:, 0], draws.cost)
