"""Tracking without a compiler, for media given by an array function: all rays take a step at a time, those that are done drop out.

The same algorithms as in `kernel_tracking`, written apart from them. Rays are followed in blocks that fit into the cache.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from fogproof.estimators.tracking.tracked import Tracked, clip_to_box, refuse

BLOCK = 16384
TOLERANCE = 1e-9


class Part(NamedTuple):
    """A block of results, and of the rays they belong to: (k, 3) or (k,) each."""

    results: slice
    origin: np.ndarray
    direction: np.ndarray
    length: np.ndarray
    start: np.ndarray
    stop: np.ndarray
    control: np.ndarray
    majorant: np.ndarray


def delta_wavefront(tracked: Tracked, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return distance [m], event (0 a collision, 1 the end of the ray) and look-ups, (n,) each."""
    distance, event, cost = np.empty(n), np.ones(n, np.int64), np.zeros(n)
    for part in _parts(tracked, n):
        end, missed, lookups = distance[part.results], event[part.results], cost[part.results]
        end[:] = part.length
        alive, t = np.flatnonzero(part.start < part.stop), part.start.copy()
        while True:
            alive = _fly(rng, part, alive, t)
            if not len(alive):
                break
            lookups[alive] += 1
            sigma = _look(tracked, part, alive, t[alive], np.zeros(len(alive)))[:, 0]
            real = part.majorant[alive] * rng.random(len(alive)) < sigma
            hit = alive[real]
            end[hit], missed[hit] = t[hit], 0
            alive = alive[~real]
    return distance, event, cost


def ratio_wavefront(tracked: Tracked, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return unbiased estimates of the transmittance (n, channels), and look-ups (n,)."""
    value, cost = np.ones((n, tracked.channels)), np.zeros(n)
    for part in _parts(tracked, n):
        weight, lookups = value[part.results], cost[part.results]
        weight *= np.exp(-part.control * (part.stop - part.start))[:, None]
        alive, t = np.flatnonzero((part.start < part.stop) & (part.majorant > 0)), part.start.copy()
        while True:
            alive = _fly(rng, part, alive, t)
            if not len(alive):
                break
            lookups[alive] += 1
            control = part.control[alive]
            sigma = _look(tracked, part, alive, t[alive], control)
            weight[alive] *= 1 - (sigma - control[:, None]) / part.majorant[alive, None]
    return value, cost


def _parts(tracked: Tracked, n: int) -> Iterator[Part]:
    bound = tracked.bound
    for first in range(0, n, BLOCK):
        last = min(first + BLOCK, n)
        rays = np.arange(first, last) if len(tracked.length) > 1 else np.zeros(last - first, int)
        origin, direction, length = tracked.origin[rays], tracked.direction[rays], tracked.length[rays]
        start, stop = clip_to_box(origin, direction, length, bound.lower, bound.upper)
        yield Part(
            slice(first, last), origin, direction, length, start, stop, bound.control[rays], bound.majorant[rays]
        )


def _fly(rng: np.random.Generator, part: Part, alive: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Move the rays that are alive to their next tentative collision; return those that are still inside."""
    t[alive] += rng.standard_exponential(len(alive)) / part.majorant[alive]
    return alive[t[alive] < part.stop[alive]]


def _look(tracked: Tracked, part: Part, alive: np.ndarray, t: np.ndarray, control: np.ndarray) -> np.ndarray:
    """Return the extinction at t (k, channels), or raise if the bound does not allow it."""
    direction, majorant = part.direction[alive], part.majorant[alive]
    sigma = tracked.field(part.origin[alive] + t[:, None] * direction, direction)
    limit = control + majorant
    fits = (sigma >= 0) & (np.abs(sigma - control[:, None]) <= (majorant + TOLERANCE * limit)[:, None])
    if not fits.all():
        k = int(np.argmin(fits.all(axis=-1)))
        refuse(float(sigma[k][~fits[k]][0]), float(limit[k]), float(t[k]))
    return sigma
