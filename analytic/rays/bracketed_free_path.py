"""The inverse of the optical thickness of any medium, found between two distances that are sure to lie on either side."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fogproof.analytic.arithmetic.budget import budget
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.media.breakpoints import extent
from fogproof.analytic.media.thickness import thickness
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import AnyMedium, Ray

STEPS = 200
"""Most halvings of a bracket."""

DOUBLINGS = 1100
"""An endless ray is searched in steps that double: so many reach the largest number there is."""

Sure = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


def bracketed_free_path(medium: AnyMedium, ray: Ray, tau: np.ndarray, channels: int | None) -> Reference:
    """Return what `free_path` returns for a medium without a closed form; ray and tau have one shape.

    Error: half the distance between a place where the thickness is surely below tau and one where it is surely not.
    Source: the thickness never falls along a ray; bisection.
    """
    shape = ray.shape if channels is None else (*ray.shape, channels)
    wanted = np.broadcast_to(tau if channels is None else np.asarray(tau)[..., None], shape).reshape(-1)
    enter, leave, _ = extent(medium, ray)
    rows = np.repeat(np.arange(len(enter)), channels or 1)
    low, high = enter[rows], leave[rows]

    def sure(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return where the thickness up to t is surely below what is wanted, and where it surely is not."""
        value, error = _up_to(medium, ray, rows, t, channels)
        return value + error < wanted, value - error >= wanted

    with np.errstate(over="ignore", invalid="ignore", under="ignore"), budget(len(enter)):
        below, beyond = sure(high)
        if np.isinf(high).any():
            high = _reached(sure, low, high, beyond)
        # Two bisections: for the last place that is surely before, and the first that is surely behind.
        first, last = _bisect(lambda t: sure(t)[0], low, high), _bisect(lambda t: ~sure(t)[1], low, high)
        value = 0.5 * (first + last)
        error = 0.5 * (last - first) + 4 * EPS * last + TINY
    none, unsure = wanted == 0, ~below & ~beyond
    value = np.where(none, 0.0, np.where(below, np.inf, value))
    error = np.where(none | below, 0.0, np.where(unsure, np.inf, error))
    return Reference(value.reshape(shape), error.reshape(shape), "bisection of the thickness", "elementary")


def _up_to(
    medium: AnyMedium, ray: Ray, rows: np.ndarray, t: np.ndarray, channels: int | None
) -> tuple[np.ndarray, np.ndarray]:
    """Return the thickness of each row's ray up to t, in each row's own channel, and its error."""
    origin, direction = ray.origin.reshape(-1, 3)[rows], ray.direction.reshape(-1, 3)[rows]
    found = thickness(medium, Ray(origin, direction, np.maximum(t, TINY)), channels)
    own = np.arange(len(rows)), np.arange(len(rows)) % (channels or 1)
    value, low, error = (x.reshape(len(rows), channels or 1)[own] for x in (found.value, found.low, found.error))
    endless = np.isinf(value)
    value, error = np.where(endless, value, value + low), np.where(endless, error, error + EPS * value)
    return np.where(t > 0, value, 0.0), np.where(t > 0, error, 0.0)


def _reached(sure: Sure, low: np.ndarray, high: np.ndarray, beyond: np.ndarray) -> np.ndarray:
    """Return finite distances by which endless rays have reached what they reach at all."""
    endless = np.isinf(high) & beyond
    finite = np.where(np.isfinite(high), high, np.maximum(2 * low, 1.0))
    for _ in range(DOUBLINGS):
        short = endless & ~sure(finite)[1]
        if not short.any():
            return finite
        finite = np.where(short, 2 * finite, finite)
    raise UnsupportedError("the thickness grows too slowly along an endless ray: give the ray a length", "ray")


def _bisect(before: Callable[[np.ndarray], np.ndarray], low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return the places where a property of distances that holds first and then never again ceases to hold."""
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        if not (high - low > 2 * EPS * high).any():
            break
        holds = before(middle)
        low, high = np.where(holds, middle, low), np.where(holds, high, middle)
    return 0.5 * (low + high)
