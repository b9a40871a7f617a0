"""Transmittance from the points of a ray towards a light: many ways at once, each looked along once.

The functions have the medium (grey), points x (3, n), unit vectors w (3, n) and the lengths `way` (n,) [m], which may be inf, and
return the transmittance (n,), or an estimate of it, and the look-ups of the medium that it took (n,).
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.media import ROOM
from fogproof.estimators.tracking.medium_data import look_ups
from fogproof.estimators.tracking.ratio import ratio_tracking
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.kinds import given

ShadowRays = Literal["exact", "ratio", "march"]
"""In closed form or cell by cell; by ratio tracking, unbiased; by a sum over midpoints, biased."""

MARCH_STEPS = 16
"""Steps of a marched shadow ray."""

Answer = tuple[np.ndarray, np.ndarray]


def shadow_transmittance(
    how: ShadowRays,
    medium: AnyMedium,
    x: np.ndarray,
    w: np.ndarray,
    way: np.ndarray,
    rng: np.random.Generator | None = None,
) -> Answer:
    """Return what the function of that name returns; only ratio tracking needs a generator."""
    match how:
        case "exact":
            return exact(medium, x, w, way)
        case "march":
            return by_marching(medium, x, w, way)
    assert rng is not None
    return by_ratio_tracking(medium, x, w, way, rng)


def by_ratio_tracking(
    medium: AnyMedium, x: np.ndarray, w: np.ndarray, way: np.ndarray, rng: np.random.Generator
) -> Answer:
    """One unbiased estimate each."""
    there = way > 0
    value, cost = np.ones_like(way), np.zeros_like(way)
    draws = ratio_tracking(medium, Ray(x.T[there], w.T[there], way[there]), rng)
    value[there], cost[there] = np.asarray(draws.value), np.asarray(draws.cost)
    return value, cost


def by_marching(medium: AnyMedium, x: np.ndarray, w: np.ndarray, way: np.ndarray, steps: int = MARCH_STEPS) -> Answer:
    """A sum over the midpoints of equal steps: a bias of the order of their square, none where the extinction is linear."""
    if np.isinf(way).any():
        raise UnsupportedError("nobody marches to a light at infinity", "shadow_rays")
    field, directions = look_ups(medium), np.ascontiguousarray(w.T)
    depth = np.zeros_like(way)
    for k in range(steps):
        at = (x + ((k + 0.5) / steps) * way * w).T
        depth += field(at, directions)[:, 0]
    return np.exp(-depth * way / steps), np.full_like(way, float(steps))


def exact(medium: AnyMedium, x: np.ndarray, w: np.ndarray, way: np.ndarray) -> Answer:
    """Closed forms, or every cell on the way."""
    own = given(medium, ROOM, "depth_towards")
    if own is None:
        name = type(medium).__name__
        raise UnsupportedError(f"shadow rays in a {name} have no closed form: take 'ratio'", "shadow_rays")
    depth, cost = own(medium, x, w, way)
    return np.exp(-depth), cost
