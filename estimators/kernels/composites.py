"""Several media in one for kernels: a chain of pairs, of which each is a medium in its region and all the rest.

What scatters, what glows and whose phase function counts depends on the place then. For every other medium `at_collision` gives
back what the path tracer knows anyway: the compiler leaves nothing of it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numba.extending import overload

from fogproof.estimators.kernels.compiling import KERNEL_OPTIONS
from fogproof.estimators.kernels.media import sigma_t
from fogproof.estimators.kernels.path_data import Region
from fogproof.estimators.kernels.regions import crossing

_CALLED = dict(KERNEL_OPTIONS)
"""Nothing here is inlined by force: chains of media would be written out at every look-up, and take minutes to compile."""


class PartData(NamedTuple):
    """One medium: data, the shape it fills, the box outside of which it is vacuum, albedo and L_e (channels,)."""

    medium: Any
    region: Region
    limits: Region
    albedo: np.ndarray
    emission: np.ndarray

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        return sigma_t(medium.medium, channel, x, y, z) if holds(medium, x, y, z) else 0.0


class PairData(NamedTuple):
    """A part and the rest, a part or a pair; exclusive where the first alone counts wherever it is."""

    first: Any
    rest: Any
    exclusive: bool

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        if medium.exclusive and holds(medium.first, x, y, z):
            return sigma_t(medium.first, channel, x, y, z)
        return sigma_t(medium.first, channel, x, y, z) + sigma_t(medium.rest, channel, x, y, z)


@njit(**KERNEL_OPTIONS)
def within(region: Region, x: float, y: float, z: float) -> bool:
    """Return whether a point is in a region."""
    enter, leave = crossing(region, x, y, z, 0.0, 0.0, 1.0)
    return enter <= 0.0 < leave


@njit(**KERNEL_OPTIONS)
def holds(part: PartData, x: float, y: float, z: float) -> bool:
    """Return whether a point is where a part is."""
    return within(part.region, x, y, z) and within(part.limits, x, y, z)


def coefficients(medium: Any, channel: int, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return sigma_t, sigma_s [1/m] and sigma_a L_e at a point; in kernels only."""
    raise NotImplementedError("runs inside kernels only")


def _of_part(medium: Any, channel: int, x: float, y: float, z: float) -> tuple[float, float, float]:
    sigma = sigma_t(medium, channel, x, y, z)
    albedo = medium.albedo[channel]
    return sigma, albedo * sigma, (1.0 - albedo) * sigma * medium.emission[channel]


def _of_pair(medium: Any, channel: int, x: float, y: float, z: float) -> tuple[float, float, float]:
    one = coefficients(medium.first, channel, x, y, z)
    if medium.exclusive and holds(medium.first, x, y, z):
        return one
    other = coefficients(medium.rest, channel, x, y, z)
    return one[0] + other[0], one[1] + other[1], one[2] + other[2]


@overload(coefficients, jit_options=_CALLED)
def _choose_coefficients(medium: Any, channel: int, x: float, y: float, z: float) -> Any:
    return _of_pair if medium.instance_class is PairData else _of_part


def share_of_rest(medium: Any, x: float, y: float, z: float) -> float:
    """Return the share of what scatters that belongs to all but the first part of a grey medium; in kernels only."""
    raise NotImplementedError("runs inside kernels only")


def _share_of_rest(medium: Any, x: float, y: float, z: float) -> float:
    if medium.exclusive and holds(medium.first, x, y, z):
        return 0.0
    one, other = coefficients(medium.first, 0, x, y, z)[1], coefficients(medium.rest, 0, x, y, z)[1]
    return other / (one + other) if one + other > 0.0 else 0.0


@overload(share_of_rest, jit_options=_CALLED)
def _choose_share(medium: Any, x: float, y: float, z: float) -> Any:
    return _share_of_rest


def at_collision(
    medium: Any, channel: int, albedo: float, emission: float, x: float, y: float, z: float
) -> tuple[float, float]:
    """Return albedo and (1 - albedo) L_e at a collision, which are those given unless the medium has several; in kernels only."""
    raise NotImplementedError("runs inside kernels only")


def _as_given(
    medium: Any, channel: int, albedo: float, emission: float, x: float, y: float, z: float
) -> tuple[float, float]:
    return albedo, (1.0 - albedo) * emission


def _of_several(
    medium: Any, channel: int, albedo: float, emission: float, x: float, y: float, z: float
) -> tuple[float, float]:
    sigma, scattering, glow = coefficients(medium, channel, x, y, z)
    return (scattering / sigma, glow / sigma) if sigma > 0.0 else (0.0, 0.0)


@overload(at_collision, jit_options=_CALLED)
def _choose_collision(medium: Any, channel: int, albedo: float, emission: float, x: float, y: float, z: float) -> Any:
    return _of_several if medium.instance_class in (PairData, PartData) else _as_given
