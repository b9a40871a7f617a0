"""From a medium and its rays to what trackers work on: data for kernels or an array function, and bounds of the extinction."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators.kernels.data import BlockBound, Lattice, RayBound
from fogproof.estimators.tracking.majorant_grid import MajorantGrid
from fogproof.estimators.tracking.medium_data import Field, bounded, extremes, look_ups, medium_data
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.media import box
from fogproof.validate import number, require

PROBES = 64
"""Points at which a majorant that somebody else has chosen is tested before any tracking."""

MOST_STEPS = 1e15
"""Tentative collisions on the whole way; beyond that, floating-point distances cannot tell one from the next."""


class Tracked(NamedTuple):
    """A medium and rays, ready for tracking.

    data      the medium for kernels; None if there is only the array function `field`
    field     points (k, 3), direction (k, 3) -> (k, channels) [1/m]
    channels  how many, 1 if grey
    bound     `RayBound` or `BlockBound` for kernels; without data, only the former
    origin, direction (rays, 3), length (rays,)
    """

    data: Any
    field: Field
    channels: int
    bound: Any
    origin: np.ndarray
    direction: np.ndarray
    length: np.ndarray


def single(ray: Ray) -> Ray:
    """Return a ray that is one ray, not a batch."""
    if ray.shape:
        raise UnsupportedError(f"an estimator looks along one ray, got a batch of shape {ray.shape}", "ray")
    return ray


def track(medium: AnyMedium, ray: Ray, majorant: float | MajorantGrid | None = None, control: Any = 0.0) -> Tracked:
    """Return what trackers need to follow the flattened rays.

    majorant  bound of sigma_t along the rays [1/m]: a number, in blocks, or None for the least that is known without a search
    control   extinction that is handled in closed form [1/m]; "low" or "middle" for the lower bound or the middle of both
    """
    origin, direction = (np.array(a.reshape(-1, 3), order="C") for a in (ray.origin, ray.direction))
    length = np.array(ray.length.reshape(-1))
    data, field, channels = medium_data(medium), look_ups(medium), medium.channels or 1
    low, high = (
        extremes(medium, origin, direction, length) if majorant is None or bounded(medium) else _unbounded(length)
    )
    lower, upper = box(medium)
    if isinstance(majorant, MajorantGrid):
        majorant.require_around(medium)
        if data is None:
            what = "a majorant grid needs a compiled medium"
            raise UnsupportedError(f"{what}; wrap a numba function f(x, y, z) in CompiledField", "majorant")
        low, high = majorant.low, majorant.high
    elif majorant is not None:
        value = number("majorant", majorant, "must be finite and > 0 [1/m]", 0, open_ends=True)
        high = np.full_like(high, value)
        low = np.minimum(low, high)
    elif getattr(medium, "majorant", None) == 0:
        raise InvalidValueError("majorant", "must be > 0 [1/m]: with 0 nobody would ever look at the medium", 0.0)
    require("majorant", high, np.isfinite(high), "must be finite [1/m]", "the extinction overflows: shorten the ray")
    if control in ("low", "middle"):
        control = np.array(low) if control == "low" else 0.5 * (low + high)
    else:
        control = np.full_like(high, number("control", control, "must be finite and >= 0 [1/m]", 0))
    residual = np.maximum(high - control, np.where(control > 0, control - low, 0.0))
    bound: Any = _bound(majorant, control, residual, lower, upper)
    found = Tracked(data, field, channels, bound, origin, direction, length)
    require_fewer_look_ups(found, medium, MOST_STEPS)
    if majorant is not None or hasattr(medium, "majorant"):
        _probe(found, medium, majorant, high)
    return found


def _unbounded(length: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return bounds of what is bounded by whoever gives a majorant."""
    return np.zeros_like(length), np.full_like(length, np.inf)


def run(kernel: Any, tracked: Tracked, rng: np.random.Generator, *results: np.ndarray) -> None:
    """Run a tracking kernel, and raise if it met an extinction that its bound does not allow."""
    from fogproof.estimators.kernels.compiling import uncached

    if getattr(tracked.data, "of_user", False):
        kernel = uncached(kernel)
    rays = (tracked.origin, tracked.direction, tracked.length)
    refuse(*kernel(rng, tracked.data, tracked.bound, *rays, *results))


def require_fewer_look_ups(tracked: Tracked, medium: AnyMedium, most: float) -> None:
    """Raise if tracking to the end of a ray means more look-ups than that."""
    lower, upper = box(medium)
    longest = float(np.minimum(tracked.length, np.linalg.norm(upper - lower)).max(initial=0.0))
    expected = longest * float(tracked.bound.majorant.max(initial=0.0))
    if expected > most:
        rule = f"must make at most {most:g} look-ups on the way to the end of a ray"
        raise InvalidValueError("majorant", rule, expected, "shorten the ray, or bound the extinction in blocks")


def refuse(sigma: float, limit: float, t: float) -> None:
    """Raise for a look-up that broke the bound; t is NaN if none did."""
    if np.isnan(t):
        return
    if not 0 <= sigma < np.inf:
        raise InvalidValueError(
            "sigma_t", f"must be finite and >= 0 [1/m] where the ray meets it at t = {t:g} m", sigma
        )
    fix = "a tracker whose majorant is too small is biased: raise it, or leave it to be found"
    raise InvalidValueError("majorant", f"must bound sigma_t = {sigma:g} [1/m], met at t = {t:g} m", float(limit), fix)


def _bound(majorant: Any, control: np.ndarray, residual: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> Any:
    if not isinstance(majorant, MajorantGrid):
        return RayBound(control, residual, lower, upper)
    return BlockBound(control, residual, Lattice.between(majorant.lower, majorant.upper, residual.shape))


def _probe(tracked: Tracked, medium: AnyMedium, majorant: Any, high: np.ndarray) -> None:
    """Look at the medium along the rays before anything is tracked: a majorant far too small would hide itself."""
    lower, upper = box(medium)
    which = np.linspace(0, len(tracked.length) - 1, PROBES).astype(int)
    origin, direction = tracked.origin[which], tracked.direction[which]
    start, stop = clip_to_box(origin, direction, tracked.length[which], lower, upper)
    t = start + np.linspace(0, 1, PROBES) * (stop - start)
    inside = stop > start
    x = (origin + t[:, None] * direction)[inside]
    sigma = tracked.field(x, direction[inside])
    limit = majorant.at(x)[1] if isinstance(majorant, MajorantGrid) else high[which][inside]
    with np.errstate(invalid="ignore"):
        bad = ~((sigma >= 0) & (sigma <= limit[:, None] * (1 + 1e-9)))
    if bad.any():
        k = int(np.flatnonzero(bad.any(axis=-1))[0])
        refuse(float(sigma[k][bad[k]][0]), float(limit[k]), float(t[inside][k]))


def clip_to_box(
    origin: np.ndarray, direction: np.ndarray, length: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return where rays (n, 3) enter and leave lower <= x < upper within [0, length], (n,) each; equal where they miss."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        one, two = (lower - origin) / direction, (upper - origin) / direction
    parallel = direction == 0
    outside = parallel & ~((origin >= lower) & (origin < upper))
    near = np.where(parallel, np.where(outside, np.inf, -np.inf), np.fmin(one, two)).max(axis=-1)
    far = np.where(parallel, np.inf, np.fmax(one, two)).min(axis=-1)
    start, stop = np.maximum(near, 0.0), np.minimum(far, length)
    missed = ~(start < stop)
    return np.where(missed, 0.0, start), np.where(missed, 0.0, stop)
