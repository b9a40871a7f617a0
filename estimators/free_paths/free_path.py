"""Free paths where the optical depth has a closed inverse: up to a surface, truncated to a segment, or of several channels."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import HalfLine, Interval
from fogproof.errors import InvalidValueError
from fogproof.estimators.blocks import IN_PLACE, blocks
from fogproof.estimators.free_paths.extinction import Constant, Extinction, as_extinction
from fogproof.validate import number


@dataclass(frozen=True)
class FreePath:
    """Distance to the next event: a collision at t < `surface`, or the surface itself.

    extinction  along the ray, see `extinction`; a number is a constant sigma_t [1/m]
    surface     distance of the surface [m], inf if there is none

    Collisions have the *density* sigma(t) e^{-depth(t)} [1/m]; the surface is reached with *probability* e^{-depth(surface)}, an
    atom; at inf it is the probability of never colliding. Event 0 is a collision, 1 the surface.
    """

    extinction: Extinction | float
    surface: float = np.inf
    dimensions: ClassVar[int] = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "extinction", as_extinction(self.extinction))
        if not self.surface > 0:
            raise InvalidValueError("surface", "must be > 0 [m]", self.surface, "inf means that there is none")

    @property
    def domain(self) -> Interval | HalfLine:
        """[0, surface], or the half line."""
        return HalfLine(0.0) if np.isinf(self.surface) else Interval(0.0, self.surface)

    @property
    def atoms(self) -> dict[float, float]:
        """The probability of reaching the surface; none if that is 0 at inf."""
        depth = float(as_extinction(self.extinction).depth(np.array(float(self.surface))))
        reached = float(np.exp(-depth))
        return {} if np.isinf(self.surface) and reached == 0 else {self.surface: reached}

    def distances(self, u: np.ndarray) -> np.ndarray:
        """Map uniforms (n, 1) to distances [m] alone, for estimators that ask no more than whether the surface is reached."""
        extinction, ends = as_extinction(self.extinction), bool(np.isfinite(self.surface))
        x = np.empty(len(u), u.dtype)
        factor = 0.0
        if isinstance(extinction, Constant) and extinction.sigma_t >= np.finfo(x.dtype).tiny:
            factor = -1 / extinction.sigma_t  # dividing each depth would cost half as much as its logarithm
        for block in blocks(len(u), IN_PLACE):
            t = x[block]
            np.negative(u[block, 0], out=t)
            np.log1p(t, out=t)  # finite for every u in [0, 1)
            if factor:
                t *= factor
            else:
                t[:] = extinction.reach(-t)
            if ends:
                np.minimum(t, self.surface, out=t)
        return x

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to distances [m] and their density [1/m], or probability where the surface is reached."""
        extinction, x = as_extinction(self.extinction), self.distances(u)
        reached = self.atoms.get(self.surface)
        pdf, event = np.empty(len(u), u.dtype), np.zeros(len(u), np.int8)
        for block in blocks(len(u)):
            p = pdf[block]
            np.subtract(1, u[block, 0], out=p)
            p *= extinction.sigma(x[block])
            if reached is not None:
                np.equal(x[block], self.surface, out=event[block].view(bool))
                np.copyto(p, reached, where=event[block].view(bool))
        return Draw(x, pdf, event=event)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of collisions at distances x (n,) [1/m]."""
        extinction = as_extinction(self.extinction)
        return extinction.sigma(x) * np.exp(-extinction.depth(x))


@dataclass(frozen=True)
class TruncatedFreePath:
    """Distance to a collision that is sure to happen before `length`: the density is divided by 1 - e^{-depth(length)}.

    extinction  along the ray; a number is a constant sigma_t [1/m]
    length      of the segment [m], finite
    """

    extinction: Extinction | float
    length: float
    dimensions: ClassVar[int] = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "extinction", as_extinction(self.extinction))
        number("length", self.length, "must be finite and > 0 [m]", 0, np.inf, open_ends=True)
        if not self._collides > 0:
            raise InvalidValueError("extinction", "must not vanish on the whole segment", self.extinction)

    @property
    def _collides(self) -> float:
        """The probability of a collision on the segment."""
        return -float(np.expm1(-as_extinction(self.extinction).depth(np.array(float(self.length)))))

    @property
    def domain(self) -> Interval:
        """[0, length]."""
        return Interval(0.0, self.length)

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to distances [m] and their density [1/m]."""
        extinction, share = as_extinction(self.extinction), self._collides
        x, pdf = np.empty((2, len(u)), u.dtype)
        for block in blocks(len(u)):
            lost = -share * u[block, 0]
            x[block] = np.clip(extinction.reach(-np.log1p(lost)), 0, self.length)
            pdf[block] = extinction.sigma(x[block]) * (1 + lost) / share
        return Draw(x, pdf)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density at distances x (n,) [1/m]."""
        extinction = as_extinction(self.extinction)
        return extinction.sigma(x) * np.exp(-extinction.depth(x)) / self._collides


@dataclass(frozen=True)
class HomogeneousSpectralFreePath:
    """Free paths that serve several channels: one channel is drawn, and the distance with its extinction.

    sigma_t  extinction coefficient of each channel [1/m]
    surface  distance of the surface [m], inf if there is none

    The density is the *mean* of the channels' densities, and the probability of the surface the mean of theirs: whatever channel
    was drawn, every channel divides by both (the balance heuristic of one sample, Veach & Guibas 1995). `weight` (n, channels)
    is the transmittance of each channel over that, bounded by the number of channels over the smallest sigma_t.
    """

    sigma_t: tuple[float, ...]
    surface: float = np.inf
    dimensions: ClassVar[int] = 2
    _paths: tuple[FreePath, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not self.sigma_t:
            raise InvalidValueError("sigma_t", "must be a list with one number a channel [1/m]", self.sigma_t)
        object.__setattr__(self, "_paths", tuple(FreePath(Constant(s), self.surface) for s in self.sigma_t))

    @property
    def domain(self) -> Interval | HalfLine:
        """[0, surface], or the half line."""
        return self._paths[0].domain

    @property
    def atoms(self) -> dict[float, float]:
        """The probability of reaching the surface, the mean over the channels."""
        reached = sum(path.atoms.get(self.surface, 0.0) for path in self._paths) / len(self._paths)
        return {self.surface: reached} if reached > 0 or np.isfinite(self.surface) else {}

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 2), the first for the channel, to distances [m], density or probability, and weights (n, channels)."""
        sigma_t = np.array(self.sigma_t, u.dtype)
        chosen = sigma_t[np.minimum(u[:, 0] * len(sigma_t), len(sigma_t) - 1).astype(np.intp)]
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.where(chosen > 0, -np.log1p(-u[:, 1]) / chosen, np.inf).astype(u.dtype)
        x = np.minimum(t, self.surface)
        hit = x >= self.surface
        pdf = np.where(hit, self.atoms.get(self.surface, 0.0), self.pdf(x))
        return Draw(x, pdf, self.eval(x) / pdf[:, None], hit.astype(np.int64))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of collisions at distances x (n,) [1/m]."""
        return (self.eval(x) * np.array(self.sigma_t)).mean(axis=-1)

    def eval(self, x: np.ndarray) -> np.ndarray:
        """Return the transmittance of each channel to distances x: (n, channels)."""
        finite = np.minimum(x, np.finfo(x.dtype).max)
        with np.errstate(over="ignore"):
            return np.exp(-np.multiply.outer(finite, np.array(self.sigma_t, x.dtype)))
