"""Flights and shadow rays in media of many colours: one channel, the hero, decides; the densities of all are kept.

`density` (channels,) is updated in place: what this stretch of the path has as its density in each channel, up to a factor that
all share. Homogeneous media have closed forms; the others count their null collisions as well (Miller et al. 2019).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba.extending import overload

from fogproof.estimators.kernels.bounds import begin, onward, piece
from fogproof.estimators.kernels.compiling import KERNEL_OPTIONS, inlined
from fogproof.estimators.kernels.flights import Flight, LightData, along
from fogproof.estimators.kernels.media import sigma_t
from fogproof.estimators.kernels.path_data import UniformSpectralData
from fogproof.estimators.kernels.tracking import breaks


def fly_in_colour(
    rng: np.random.Generator, medium: Any, bound: Any, hero: int, at: Any, length: float, density: np.ndarray
) -> Flight:
    """Return the flight from at = (x, y, z, dx, dy, dz) over at most `length`; in kernels only."""
    raise NotImplementedError("runs inside kernels only")


def shine_in_colour(
    rng: np.random.Generator, medium: Any, bound: Any, at: Any, length: float, through: np.ndarray
) -> LightData:
    """Write the transmittance of each channel over `length` to `through` (channels,); in kernels only."""
    raise NotImplementedError("runs inside kernels only")


@inlined
def normalise(density: np.ndarray) -> None:
    """Divide by the largest, so that long paths do not underflow."""
    largest = 0.0
    for c in range(len(density)):
        largest = max(largest, density[c])
    for c in range(len(density)):
        density[c] /= largest


def _fly_uniform(
    rng: np.random.Generator, medium: Any, bound: Any, hero: int, at: Any, length: float, density: np.ndarray
) -> Flight:
    sigma = medium.sigma
    t = rng.standard_exponential() / sigma[hero]
    hit = t < length
    t = min(t, length)
    for c in range(len(density)):
        more = sigma[c] - sigma[hero]  # what they share cancels: exp must not underflow in all channels
        if more != 0.0:
            density[c] *= np.exp(-more * t)
        if hit:
            density[c] *= sigma[c] / sigma[hero]
    normalise(density)
    return Flight(t, hit, 1, np.nan, np.nan)


def _shine_uniform(
    rng: np.random.Generator, medium: Any, bound: Any, at: Any, length: float, through: np.ndarray
) -> LightData:
    for c in range(len(through)):
        through[c] = np.exp(-medium.sigma[c] * length) if medium.sigma[c] > 0.0 else 1.0
    return LightData(np.nan, 1, np.nan, np.nan)


def _fly_tracked(
    rng: np.random.Generator, medium: Any, bound: Any, hero: int, at: Any, length: float, density: np.ndarray
) -> Flight:
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
            x, y, z = line.ox + t * line.dx, line.oy + t * line.dy, line.oz + t * line.dz
            real = majorant * rng.random() < sigma_t(medium, hero, x, y, z)
            for c in range(len(density)):
                sigma = sigma_t(medium, c, x, y, z)
                if breaks(sigma, 0.0, majorant):
                    return Flight(t, False, lookups, sigma, majorant)
                density[c] *= sigma if real else max(0.0, majorant - sigma)
            normalise(density)
            if real:
                return Flight(min(t, stop), True, lookups, np.nan, np.nan)
            depth = rng.standard_exponential()
            room = majorant * (stop - t)
        depth -= room
        cell = onward(bound, line, cell)
    return Flight(length, False, lookups, np.nan, np.nan)


def _shine_tracked(
    rng: np.random.Generator, medium: Any, bound: Any, at: Any, length: float, through: np.ndarray
) -> LightData:
    line = along(at)
    cell = begin(bound, line, length)
    depth, lookups = rng.standard_exponential(), 0
    for c in range(len(through)):
        through[c] = 1.0
    while cell.t < cell.stop:
        stop, _, majorant = piece(bound, 0, cell)
        t = cell.t
        room = majorant * (stop - t)
        while depth < room:
            t += depth / majorant
            lookups += 1
            for c in range(len(through)):
                sigma = sigma_t(medium, c, line.ox + t * line.dx, line.oy + t * line.dy, line.oz + t * line.dz)
                if breaks(sigma, 0.0, majorant):
                    return LightData(np.nan, lookups, sigma, majorant)
                through[c] *= 1.0 - sigma / majorant
            depth = rng.standard_exponential()
            room = majorant * (stop - t)
        depth -= room
        cell = onward(bound, line, cell)
    return LightData(np.nan, lookups, np.nan, np.nan)


_INLINED = {"forceinline": True, **KERNEL_OPTIONS}


@overload(fly_in_colour, jit_options=_INLINED)
def _choose_fly(
    rng: np.random.Generator, medium: Any, bound: Any, hero: int, at: Any, length: float, density: np.ndarray
) -> Any:
    return _fly_uniform if medium.instance_class is UniformSpectralData else _fly_tracked


@overload(shine_in_colour, jit_options=_INLINED)
def _choose_shine(
    rng: np.random.Generator, medium: Any, bound: Any, at: Any, length: float, through: np.ndarray
) -> Any:
    return _shine_uniform if medium.instance_class is UniformSpectralData else _shine_tracked
