"""Transmittance from the points of a ray towards a light: many ways at once, each looked along once.

The functions have the medium (grey), points x (3, n), unit vectors w (3, n) and the lengths `way` (n,) [m], which may be inf, and
return the transmittance (n,), or an estimate of it, and the look-ups of the medium that it took (n,).
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.tracking.medium_data import look_ups
from fogproof.estimators.tracking.ratio import ratio_tracking
from fogproof.estimators.tracking.regular import regular_tracking
from fogproof.scene import AnyMedium, ExponentialMedium, LinearMedium, Medium, Ray, VoxelGrid

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
    """Closed forms, or every voxel on the way."""
    cost = np.ones_like(way)
    match medium:
        case Medium():
            depth = _constant(float(medium.sigma_t), way)
        case LinearMedium():
            depth = _linear(float(np.asarray(medium.sigma_0)) + medium.gradient @ x, medium.gradient @ w, way)
        case ExponentialMedium():
            depth = _exponential(float(np.asarray(medium.sigma_0)) * np.exp(medium.rate @ x), medium.rate @ w, way)
        case VoxelGrid():
            rays = Ray(x.T, w.T, np.maximum(way, np.finfo(float).tiny))
            walks = regular_tracking(medium, rays)
            depth, cost = walks.tau, walks.cells
        case _:
            name = type(medium).__name__
            raise UnsupportedError(f"shadow rays in a {name} have no closed form: take 'ratio'", "shadow_rays")
    return np.exp(-depth), cost


def _constant(sigma: float, way: np.ndarray) -> np.ndarray:
    return sigma * way if sigma > 0 else np.zeros_like(way)


def _linear(near: np.ndarray, slope: np.ndarray, way: np.ndarray) -> np.ndarray:
    """The area under a line clamped at 0: a trapezium, or a triangle where the line crosses 0 on the way."""
    with np.errstate(divide="ignore", invalid="ignore"):
        far = np.where(slope == 0, near, near + slope * way)
        high = np.maximum(np.maximum(near, far), 0)
        crosses = (near < 0) != (far < 0)
        base = np.where(crosses, high / np.abs(slope), way)
        mean = np.where(crosses, 0.5 * high, np.maximum(0.5 * (near + far), 0))
        return np.where(mean > 0, mean * base, 0.0)


def _exponential(near: np.ndarray, rate: np.ndarray, way: np.ndarray) -> np.ndarray:
    """near (e^(rate way) - 1)/rate, near way where the rate is 0."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        x = rate * way
        depth = np.where(np.abs(x) > 0, near * np.expm1(x) / rate, near * way)
    return np.where(near > 0, depth, 0.0)
