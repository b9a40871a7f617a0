"""Where the coefficients along a ray jump or kink, and where the medium ends: quadrature has to be told."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.kinds import given
from fogproof.scene.media import box

ROOM = "fogproof.analytic.media"


class Breaks(NamedTuple):
    """Where n rays enter and leave what the medium fills, (n,) each, and breaks anywhere on their lines, (n, any) each [m]."""

    enter: np.ndarray
    leave: np.ndarray
    found: list[np.ndarray]


def extent(medium: AnyMedium, ray: Ray) -> Breaks:
    """Return where the flattened rays enter and leave the medium, with leave = inf where it has no end, and breaks."""
    origin, direction, length = ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3), ray.length.reshape(-1)
    own = given(medium, ROOM, "breakpoints")
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if own is not None:
            found: Breaks = own(medium, origin, direction, length)
            return found
        return Breaks(*between(origin, direction, *box(medium), length), [])


def breakpoints(medium: AnyMedium, ray: Ray) -> np.ndarray:
    """Return (n, B) sorted distances along the flattened rays: both ends of what needs integrating, and breaks between.

    There is vacuum before the first and after the last. A missed break would cost quadrature time, not truth: its
    error estimate sees the jump. An infinite ray through a medium without end is refused.
    """
    enter, leave, found = extent(medium, ray)
    if np.isinf(leave).any():
        name = type(medium).__name__
        raise UnsupportedError(f"an infinite ray through a {name} without end: give the ray a length", "ray")
    clean = [np.nan_to_num(b, nan=0.0, posinf=np.inf, neginf=-np.inf) for b in found]
    breaks = np.concatenate([np.empty((len(enter), 0)), *clean], axis=-1)
    breaks = np.clip(breaks, enter[:, None], leave[:, None])
    return np.sort(np.concatenate([enter[:, None], breaks, leave[:, None]], axis=-1), axis=-1)


def between(
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
