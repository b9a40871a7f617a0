"""Shadows of occluders on rays: the interval of each ray that a light does not reach, by roots of quadratics.

The points that a convex occluder hides from a point (or from parallel light) form a convex set, so each ray meets it in one
interval. Edges are taken with a margin, for an occluder a little larger and one a little smaller: what lies between is
lit or dark. In the limit of a light at infinity its direction of travel takes the place of the light's position.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.scene.kinds import given
from fogproof.scene.occluders import Occluder

ROOM = "fogproof.analytic.occluders"

Stretch = tuple[np.ndarray, np.ndarray]


class Shadow(NamedTuple):
    """Distances from the ray's origin [m], (n,): dark in [dark_start, dark_end], lit outside [start, end]; NaN if none."""

    start: np.ndarray
    dark_start: np.ndarray
    dark_end: np.ndarray
    end: np.ndarray


def shadow_of_point(occluder: Occluder, ray: FlatRays, light: tuple[float, float, float]) -> Shadow:
    """Return the shadow that the occluder casts on each (flattened) ray in the light of a point."""
    origin, d = ray.origin, ray.direction
    p = np.array(light)
    return _with_margin(
        occluder,
        np.abs(origin).max(axis=1) + np.abs(p).max(),
        lambda o, m: given(o, ROOM, "from_point")(o, origin, d, p, m),
    )


def shadow_of_direction(occluder: Occluder, ray: FlatRays, travel: tuple[float, float, float]) -> Shadow:
    """Return the shadow that the occluder casts on each (flattened) ray in parallel light."""
    origin, d = ray.origin, ray.direction
    v = np.array(travel)
    return _with_margin(
        occluder, np.abs(origin).max(axis=1), lambda o, m: given(o, ROOM, "from_direction")(o, origin, d, v, m)
    )


def _with_margin(occluder: Occluder, scale: np.ndarray, interval: Callable[[Occluder, np.ndarray], Stretch]) -> Shadow:
    reach = scale + np.abs(occluder.center).max() + occluder.radius
    with np.errstate(all="ignore"):
        start, end = interval(occluder, 32 * EPS * reach)
        dark_start, dark_end = interval(occluder, -32 * EPS * reach)
    return Shadow(start, dark_start, dark_end, end)


def dot(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the dot products over the last axis."""
    return np.sum(x * y, axis=-1)


def where_positive(a: np.ndarray, b: np.ndarray, c: np.ndarray, forward1: Any = 0.0, forward0: Any = 1.0) -> Stretch:
    """Return the interval where a t^2 + 2 b t + c >= 0 and forward1 t + forward0 >= 0; NaN if there is none.

    The quadratic is positive inside a double cone or a cylinder, and the linear form in the nappe that counts.
    """
    root = np.sqrt(np.where(a > 0, np.maximum(b * b - a * c, 0.0), b * b - a * c))
    q = -(b + np.copysign(root, b))
    first, second = np.where(q == 0, 0.0, c / q), q / a
    low, high = np.fmin(first, second), np.fmax(first, second)
    ahead = forward1 > 0
    opening = (np.where(ahead, high, -np.inf), np.where(ahead, np.inf, low))
    middle = 0.5 * (low + high)
    closed = (a < 0) & (forward1 * middle + forward0 > 0)
    everywhere = (a == 0) & (b == 0) & (c >= 0)
    low = np.where(a > 0, opening[0], np.where(closed, low, np.where(everywhere, -np.inf, np.nan)))
    high = np.where(a > 0, opening[1], np.where(closed, high, np.where(everywhere, np.inf, np.nan)))
    return low, high


def behind(cone: Stretch, enter: np.ndarray, leave: np.ndarray, before: Callable[[np.ndarray], np.ndarray]) -> Stretch:
    """Return the part of the cone behind the ball, and in it: a line that meets the ball ends or begins at its front."""
    low, high = cone
    middle = np.where(np.isinf(low) | np.isinf(high), np.inf, 0.5 * (low + high))
    missed = np.isnan(enter)
    in_front = missed & before(middle)
    start = np.where(missed, low, np.where(before(enter), enter, low))
    end = np.where(missed, high, np.where(before(leave), leave, high))
    return np.where(in_front, np.nan, start), np.where(in_front, np.nan, end)


def beyond(low: np.ndarray, high: np.ndarray, past0: np.ndarray, past1: np.ndarray) -> Stretch:
    """Return the part of the interval where past0 + past1 t >= 0."""
    crossing = -past0 / past1
    low = np.where(past1 > 0, np.maximum(low, crossing), low)
    high = np.where(past1 < 0, np.minimum(high, crossing), high)
    nothing = (past1 == 0) & (past0 < 0)
    return np.where(nothing, np.nan, low), np.where(nothing, np.nan, high)
