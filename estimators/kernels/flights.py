"""Flights to the next collision and transmittance along shadow rays, chosen by the type of the medium at compile time.

Homogeneous media have closed forms; all others are tracked under their bound: delta tracking for flights, ratio tracking for
shadow rays. `Flight` and `Light` tell of a look-up that broke the bound, as the trackers do.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba.extending import overload

from fogproof.estimators.kernels.bounds import begin, onward, piece
from fogproof.estimators.kernels.compiling import KERNEL_OPTIONS, inlined
from fogproof.estimators.kernels.lattice import Line, reciprocal
from fogproof.estimators.kernels.media import sigma_t
from fogproof.estimators.kernels.path_data import UniformData
from fogproof.estimators.kernels.tracking import breaks


class Flight(NamedTuple):
    """Where a flight ends.

    t        distance [m]; that of the end if there was no collision
    hit      whether it ended in a collision
    lookups  of the medium
    sigma, limit  extinction that broke the bound, and what it may have been; limit is NaN if none did
    """

    t: float
    hit: bool
    lookups: int
    sigma: float
    limit: float


class LightData(NamedTuple):
    """Transmittance of a way, or an unbiased estimate of it, and the same as above."""

    value: float
    lookups: int
    sigma: float
    limit: float


def fly(rng: np.random.Generator, medium: Any, bound: Any, at: Any, length: float) -> Flight:
    """Return the flight from a point in a direction, at = (x, y, z, dx, dy, dz), over at most `length`; in kernels only."""
    raise NotImplementedError("runs inside kernels only")


def shine(rng: np.random.Generator, medium: Any, bound: Any, at: Any, length: float) -> LightData:
    """Return the transmittance from a point in a direction over `length`; in kernels only."""
    raise NotImplementedError("runs inside kernels only")


@inlined
def along(at: tuple[float, float, float, float, float, float]) -> Line:
    """Return the line from (x, y, z) along (dx, dy, dz) for walking through cells."""
    x, y, z, dx, dy, dz = at
    return Line(x, y, z, dx, dy, dz, reciprocal(dx), reciprocal(dy), reciprocal(dz))


def _fly_uniform(rng: np.random.Generator, medium: Any, bound: Any, at: Any, length: float) -> Flight:
    t = rng.standard_exponential() / medium.sigma
    return Flight(min(t, length), t < length, 1, np.nan, np.nan)


def _shine_uniform(rng: np.random.Generator, medium: Any, bound: Any, at: Any, length: float) -> LightData:
    return LightData(np.exp(-medium.sigma * length) if medium.sigma > 0.0 else 1.0, 1, np.nan, np.nan)


def _fly_tracked(rng: np.random.Generator, medium: Any, bound: Any, at: Any, length: float) -> Flight:
    line = along(at)
    cell = begin(bound, line, length)
    depth, lookups = rng.standard_exponential(), 0
    while cell.t < cell.stop:
        stop, _, majorant = piece(bound, 0, cell)
        t = cell.t
        room = majorant * (stop - t)
        while depth < room:
            t += depth / majorant
            lookups += 1
            sigma = sigma_t(medium, 0, line.ox + t * line.dx, line.oy + t * line.dy, line.oz + t * line.dz)
            if breaks(sigma, 0.0, majorant):
                return Flight(t, False, lookups, sigma, majorant)
            if majorant * rng.random() < sigma:
                return Flight(min(t, stop), True, lookups, np.nan, np.nan)
            depth = rng.standard_exponential()
            room = majorant * (stop - t)
        depth -= room
        cell = onward(bound, line, cell)
    return Flight(length, False, lookups, np.nan, np.nan)


def _shine_tracked(rng: np.random.Generator, medium: Any, bound: Any, at: Any, length: float) -> LightData:
    line = along(at)
    cell = begin(bound, line, length)
    depth, lookups, value = rng.standard_exponential(), 0, 1.0
    while cell.t < cell.stop:
        stop, _, majorant = piece(bound, 0, cell)
        t = cell.t
        room = majorant * (stop - t)
        while depth < room:
            t += depth / majorant
            lookups += 1
            sigma = sigma_t(medium, 0, line.ox + t * line.dx, line.oy + t * line.dy, line.oz + t * line.dz)
            if breaks(sigma, 0.0, majorant):
                return LightData(value, lookups, sigma, majorant)
            value *= 1.0 - sigma / majorant
            depth = rng.standard_exponential()
            room = majorant * (stop - t)
        depth -= room
        cell = onward(bound, line, cell)
    return LightData(value, lookups, np.nan, np.nan)


_INLINED = {"forceinline": True, **KERNEL_OPTIONS}


@overload(fly, jit_options=_INLINED)
def _choose_fly(rng: np.random.Generator, medium: Any, bound: Any, at: Any, length: float) -> Any:
    return _fly_uniform if medium.instance_class is UniformData else _fly_tracked


@overload(shine, jit_options=_INLINED)
def _choose_shine(rng: np.random.Generator, medium: Any, bound: Any, at: Any, length: float) -> Any:
    return _shine_uniform if medium.instance_class is UniformData else _shine_tracked
