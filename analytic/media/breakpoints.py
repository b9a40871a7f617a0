"""Where the coefficients along a ray jump or kink, and where the medium ends: quadrature has to be told."""

from __future__ import annotations

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.scene import AnyMedium, LinearMedium, OpenGLFog, PiecewiseConstantMedium, Procedural, Ray, VoxelGrid


def breakpoints(medium: AnyMedium, ray: Ray) -> np.ndarray:
    """Return (n, B) sorted distances along the flattened rays: both ends of what needs integrating, and breaks between.

    There is vacuum before the first and after the last. A missed break would cost quadrature time, not truth: its
    error estimate sees the jump. An infinite ray through a medium without end is refused.
    """
    origin, direction, length = ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3), ray.length.reshape(-1)
    enter, leave, found = np.zeros_like(length), length, [np.empty((len(length), 0))]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        match medium:
            case LinearMedium():
                gradient = np.atleast_2d(medium.gradient)
                zero = -(np.atleast_1d(medium.sigma_0) + origin @ gradient.T) / (direction @ gradient.T)
                found.append(np.where(np.isnan(zero), 0.0, zero))
            case OpenGLFog():
                found.append(np.broadcast_to([medium.start, medium.end], (len(length), 2)))
                leave = np.minimum(length, medium.end) if medium.mode == "linear" else length
            case PiecewiseConstantMedium():
                height, rise = (origin @ medium.axis)[:, None], (direction @ medium.axis)[:, None]
                found.append((medium.boundaries - height) / rise)
                enter, leave = _slab(height, rise, medium.boundaries[:1], medium.boundaries[-1:], length)
            case VoxelGrid() | Procedural():
                enter, leave = _slab(origin, direction, medium.lower, medium.upper, length)
                found += _planes(medium, origin, direction) if isinstance(medium, VoxelGrid) else []
    if np.isinf(leave).any():
        name = type(medium).__name__
        raise UnsupportedError(f"an infinite ray through a {name} without end: give the ray a length", "ray")
    breaks = np.concatenate([np.nan_to_num(b, nan=0.0, posinf=np.inf, neginf=-np.inf) for b in found], axis=-1)
    breaks = np.clip(breaks, enter[:, None], leave[:, None])
    return np.sort(np.concatenate([enter[:, None], breaks, leave[:, None]], axis=-1), axis=-1)


def _slab(
    origin: np.ndarray, direction: np.ndarray, lower: np.ndarray, upper: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return where rays enter and leave lower <= origin + t direction <= upper within [0, length], equal if never."""
    one, two = (lower - origin) / direction, (upper - origin) / direction
    parallel = direction == 0
    outside = parallel & ((origin < lower) | (origin > upper))
    near = np.where(parallel, np.where(outside, np.inf, -np.inf), np.fmin(one, two))
    far = np.where(parallel, np.inf, np.fmax(one, two))
    enter, leave = np.maximum(near.max(axis=-1), 0.0), np.minimum(far.min(axis=-1), length)
    missed = ~(enter < leave)
    return np.where(missed, 0.0, enter), np.where(missed, 0.0, leave)


def _planes(grid: VoxelGrid, origin: np.ndarray, direction: np.ndarray) -> list[np.ndarray]:
    """Return where rays meet the planes between voxels, or through their centres if the grid is trilinear."""
    found = []
    for i, n in enumerate(grid.sigma_t.shape[:3]):
        between = np.arange(n) + 0.5 if grid.interpolation == "trilinear" else np.arange(1.0, n)
        planes = grid.lower[i] + between * ((grid.upper[i] - grid.lower[i]) / n)
        found.append((planes - origin[:, i, None]) / direction[:, i, None])
    return found
