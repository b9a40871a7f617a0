"""One ray through a grey medium, for estimators of the transmittance that choose their places in NumPy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators.tracking.medium_data import Field, extremes, grey_medium, look_ups
from fogproof.estimators.tracking.tracked import clip_to_box, single
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.media import box
from fogproof.validate import number

MOST_LOOK_UPS = 1e9
"""Of one realisation."""


@dataclass(frozen=True, eq=False)
class RayLooks:
    """The part of a ray that lies in the box of its medium."""

    medium: AnyMedium
    ray: Ray

    def __post_init__(self) -> None:
        single(self.ray)
        grey_medium(self.medium)

    @cached_property
    def ends(self) -> tuple[float, float]:
        """Where the ray enters and leaves the box [m]; equal if it misses it."""
        ray = self.ray
        start, stop = clip_to_box(ray.origin[None], ray.direction[None], ray.length[None], *box(self.medium))
        if np.isinf(stop[0]):
            raise UnsupportedError("nobody looks at an infinite ray to its end: give the ray a length", "ray")
        return float(start[0]), float(stop[0])

    @property
    def length(self) -> float:
        """Of that part [m]."""
        return self.ends[1] - self.ends[0]

    @cached_property
    def _field(self) -> Field:
        return look_ups(self.medium)

    def sigma(self, t: np.ndarray) -> np.ndarray:
        """Return the extinction at distances (...) [1/m]."""
        flat = t.ravel()
        x = self.ray.origin + flat[:, None] * self.ray.direction
        found = self._field(x, np.broadcast_to(self.ray.direction, x.shape))[:, 0]
        good = (found >= 0) & (found < np.inf)
        if not good.all():
            k = int(np.argmin(good))
            where = f"must be finite and >= 0 [1/m] where the ray meets it at t = {flat[k]:g} m"
            raise InvalidValueError("sigma_t", where, float(found[k]))
        return found.reshape(t.shape)

    def bound(self) -> float:
        """Return the least bound of the extinction along the ray that is known without a search [1/m]."""
        ray = self.ray
        high = extremes(self.medium, ray.origin[None], ray.direction[None], np.atleast_1d(ray.length))[1]
        return float(high[0])

    def rate(self, name: str, value: float | None) -> float:
        """Return a rate of tentative collisions [1/m], > 0, under which a realisation ends in time."""
        rate = self.bound() if value is None else number(name, value, "must be finite and > 0 [1/m]", 0, open_ends=True)
        if rate * self.length > MOST_LOOK_UPS:
            rule = f"must make at most {MOST_LOOK_UPS:g} look-ups on the way to the end of a ray"
            raise InvalidValueError(name, rule, rate * self.length, "shorten the ray")
        return rate

    def flights(
        self, rng: np.random.Generator, n: int, rate: float
    ) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Yield, step by step, which of n walkers are on their way, where they collide [m], and the extinction there.

        The caller ends walkers by writing infinity to their place.
        """
        start, stop = self.ends
        t = np.full(n, start)
        alive = np.arange(n if rate > 0 and stop > start else 0)
        while len(alive):
            t[alive] += rng.standard_exponential(len(alive)) / rate
            alive = alive[t[alive] < stop]
            if len(alive):
                yield alive, t, self.sigma(t[alive])

    def combs(self, rng: np.random.Generator, n: int, points: int) -> np.ndarray:
        """Return n estimates of the optical depth, each from `points` equidistant looks behind one random offset."""
        return self.depth(rng.random(n), points)

    def depth(self, offset: np.ndarray, points: int) -> np.ndarray:
        """Return the mean extinction at (i + offset)/points of the way, times the way, for offsets (n,) in [0, 1)."""
        start, stop = self.ends
        if stop == start:
            return np.zeros(len(offset))
        t = start + (stop - start) * (np.arange(points) + offset[:, None]) / points
        return (stop - start) * self.sigma(t).mean(axis=1)
