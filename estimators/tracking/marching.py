"""Ray marching: the optical depth by a Riemann sum. Biased, by an amount that falls with the step as its rule says.

Midpoints give a bias of order step^2, and none if the extinction is linear; right ends, as often printed, one of order step. The
step follows from the medium: two looks for each period of the highest spatial frequency that is in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal, get_args

import numpy as np

from fogproof.contracts import Draw, Draws
from fogproof.domains import Interval
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators.media import ROOM
from fogproof.estimators.tracking.medium_data import look_ups
from fogproof.estimators.tracking.tracked import clip_to_box, single
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.kinds import given
from fogproof.scene.media import box
from fogproof.validate import number

Rule = Literal["midpoint", "right"]
MOST_STEPS = 10_000_000


def feature_size(medium: AnyMedium, ray: Ray) -> float:
    """Return half a period of the highest frequency at which the extinction varies along one ray [m]; inf if it does not.

    A grid of voxels h holds frequencies up to 1 / (2 h) on each axis, so |w| / h summed over the axes is what the direction w
    sees of them. An exponential is taken by its scale height, layers by the thinnest of them.
    """
    own = given(medium, ROOM, "feature_size")
    if own is None:
        raise UnsupportedError(
            f"how fine a {type(medium).__name__} is (feature_size) is not known: give a step, where there is one",
            "step",
        )
    size: float = own(medium, ray)
    return size


@dataclass(frozen=True, eq=False)
class RayMarch:
    """The optical depth along one ray as a sum over equal steps, from where the ray enters the medium to where it leaves.

    step  [m]; None for the feature size of the medium. It is shortened so that a whole number of steps fits.
    rule  where in each step the medium is looked at: "midpoint", or "right" for its far end
    """

    medium: AnyMedium
    ray: Ray
    step: float | None = None
    rule: Rule = "midpoint"

    def __post_init__(self) -> None:
        single(self.ray)
        if self.rule not in get_args(Rule):
            raise InvalidValueError("rule", f"must be one of {', '.join(get_args(Rule))}", self.rule)
        if self.step is not None:
            number("step", self.step, "must be finite and > 0 [m]", 0, open_ends=True)
        elif np.isinf(getattr(self.medium, "detail", 0.0)):
            raise InvalidValueError("step", "must be given if the medium does not state its detail", None)

    @cached_property
    def edges(self) -> np.ndarray:
        """Ends of the steps (steps + 1,) [m]; a single step of no width if the ray misses the medium."""
        ray = self.ray
        start, stop = clip_to_box(ray.origin[None], ray.direction[None], ray.length[None], *box(self.medium))
        if np.isinf(stop[0]):
            raise UnsupportedError("nobody can march along an infinite ray: give the ray a length", "ray")
        steps = (stop[0] - start[0]) / (self.step or feature_size(self.medium, ray))
        if steps > MOST_STEPS:
            raise InvalidValueError("step", f"must make at most {MOST_STEPS} steps", self.step)
        return np.linspace(start[0], stop[0], max(1, int(np.ceil(steps))) + 1)

    @cached_property
    def sigma(self) -> np.ndarray:
        """The extinction of each step (steps, channels) [1/m]."""
        low, high = self.edges[:-1], self.edges[1:]
        if low[0] == high[0]:
            return np.zeros((1, self.medium.channels or 1))
        t = 0.5 * (low + high) if self.rule == "midpoint" else high
        x = self.ray.origin + t[:, None] * self.ray.direction
        return look_ups(self.medium)(x, np.broadcast_to(self.ray.direction, x.shape))

    @cached_property
    def depths(self) -> np.ndarray:
        """The optical depth at each edge (steps + 1, channels)."""
        gained = self.sigma * np.diff(self.edges)[:, None]
        return np.concatenate([np.zeros((1, gained.shape[1])), np.cumsum(gained, axis=0)])


@dataclass(frozen=True, eq=False)
class MarchedTransmittance:
    """exp(-optical depth) by marching: no variance, but a bias. The arguments are those of `RayMarch`."""

    medium: AnyMedium
    ray: Ray
    step: float | None = None
    rule: Rule = "midpoint"

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n times the same value, (n,) or (n, channels), at the cost of the steps."""
        march = RayMarch(self.medium, self.ray, self.step, self.rule)
        value = np.exp(-march.depths[-1])
        value = value if self.medium.channels else value[0]
        return Draws(
            np.broadcast_to(value, (n, *np.shape(value))), np.full(n, float(np.count_nonzero(np.diff(march.edges))))
        )


@dataclass(frozen=True, eq=False)
class MarchedFreePath:
    """Distance to the first collision in what marching makes of the medium: constant extinction in each step.

    The medium is marched through once; each sample is then a search in the table of optical depths (Kulla & Fajardo 2012). The
    density claimed is that of the steps, which a convergence study compares with the medium's own.
    """

    medium: AnyMedium
    ray: Ray
    step: float | None = None
    rule: Rule = "midpoint"
    dimensions: ClassVar[int] = 1

    def __post_init__(self) -> None:
        if self.medium.channels is not None:
            raise UnsupportedError(
                f"the medium has {self.medium.channels} channels; this sampler follows one", "medium"
            )
        number("length of the ray", self.ray.length, "must be finite [m]")

    @cached_property
    def _march(self) -> RayMarch:
        return RayMarch(self.medium, self.ray, self.step, self.rule)

    @property
    def domain(self) -> Interval:
        """[0, length]."""
        return Interval(0.0, float(self.ray.length))

    @property
    def atoms(self) -> dict[float, float]:
        """The probability of reaching the end of the ray, as the steps have it."""
        return {float(self.ray.length): float(np.exp(-self._march.depths[-1, 0]))}

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to distances [m] and the density claimed [1/m], or probability at the end of the ray."""
        edges, table = self._march.edges, self._march.depths[:, 0]
        depth = -np.log1p(-u[:, 0])
        found = np.searchsorted(table, depth, side="right") - 1
        missed, step = found == len(table) - 1, np.minimum(found, len(table) - 2)
        sigma = self._march.sigma[step, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.minimum(edges[step] + (depth - table[step]) / sigma, edges[step + 1])
        through = np.exp(-np.minimum(depth, table[-1]))
        pdf = np.where(missed, through, sigma * through)
        return Draw(np.where(missed, float(self.ray.length), t), pdf, event=missed.astype(np.int64))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density claimed at distances x (n,) [1/m]."""
        edges, table = self._march.edges, self._march.depths[:, 0]
        step = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
        inside = (x >= edges[0]) & (x <= edges[-1])
        sigma = self._march.sigma[step, 0]
        return np.where(inside, sigma * np.exp(-(table[step] + sigma * (x - edges[step]))), 0.0)
