"""Where on a segment the one scattering event is placed, and how the ways of placing it are combined."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, Protocol

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import HalfLine, Interval
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators.airlight.equiangular import Equiangular
from fogproof.estimators.airlight.lighting import breadth, focus, foot
from fogproof.estimators.airlight.lit_medium import LitMedium
from fogproof.estimators.free_paths.free_path import FreePath, TruncatedFreePath
from fogproof.validate import number

Placing = Literal["equiangular", "free-path", "distance", "uniform", "mixed"]
"""Equiangular around the light; a free path, which may leave the segment; one that ends on it; uniform; equiangular or distance
by the toss of a coin."""


class Placer(Protocol):
    """A sampler of distances from the start of the segment; event 1 where the path has left it."""

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to distances and their density."""

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density at distances x (n,) [1/m]."""


@dataclass(frozen=True)
class Uniform:
    """Any place of [0, length] alike."""

    length: float
    dimensions: ClassVar[int] = 1

    def __post_init__(self) -> None:
        fix = "nothing is uniform on a ray without end"
        number("length", self.length, "must be finite and > 0 [m]", 0, np.inf, open_ends=True, fix=fix)

    @property
    def domain(self) -> Interval:
        """[0, length]."""
        return Interval(0.0, self.length)

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to distances and their density."""
        return Draw(self.length * u[:, 0], np.full(len(u), 1 / self.length))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density at distances x (n,) [1/m]."""
        return np.full(len(x), 1 / self.length)


@dataclass(frozen=True)
class Shifted:
    """Equiangular distances, counted from the start of the segment and not from the foot of the perpendicular."""

    sampler: Equiangular
    dimensions: ClassVar[int] = 1

    @property
    def domain(self) -> Interval | HalfLine:
        """[0, length], or the half line."""
        return HalfLine(0.0) if np.isinf(self.sampler.b) else Interval(0.0, self.sampler.b - self.sampler.a)

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to distances and their density."""
        draw = self.sampler.sample(u)
        return draw._replace(x=draw.x - self.sampler.a)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density at distances x (n,) [1/m]."""
        return self.sampler.pdf(x + self.sampler.a)


@dataclass(frozen=True)
class OneSample:
    """One of two samplers by the toss of a fair coin; whichever it was, the density is the mean of both.

    That is the balance heuristic for one sample (Veach & Guibas 1995): no sample has a smaller density than half of what the
    better of the two gives it. The coin and the distance come from the same uniform.
    """

    first: Placer
    second: Placer
    domain: Interval | HalfLine
    dimensions: ClassVar[int] = 1

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to distances and their density."""
        heads = u[:, 0] < 0.5
        fresh = 2 * u
        fresh[~heads] -= 1  # exact in binary
        x = np.empty(len(u), u.dtype)
        x[heads], x[~heads] = self.first.sample(fresh[heads]).x, self.second.sample(fresh[~heads]).x
        return Draw(x, self.pdf(x))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density at distances x (n,) [1/m]."""
        return 0.5 * (self.first.pdf(x) + self.second.pdf(x))


def placer(lit: LitMedium, placing: Placing) -> Placer:
    """Return the sampler of one scattering event on the segment of a lit medium, which must not be empty."""
    match placing:
        case "equiangular":
            point = focus(lit.light)
            if point is None:
                raise UnsupportedError("equiangular sampling needs a light at a point", "light")
            h, along = foot(lit.ray, point)
            h = float(np.hypot(h, breadth(lit.light)))
            a = lit.start - along
            return Shifted(Equiangular(h, a, a + lit.length))
        case "free-path":
            return FreePath(lit.extinction, lit.length)
        case "distance":
            endless = np.isinf(lit.length)
            return FreePath(lit.extinction) if endless else TruncatedFreePath(lit.extinction, lit.length)
        case "uniform":
            return Uniform(lit.length)
        case "mixed":
            equiangular = placer(lit, "equiangular")
            assert isinstance(equiangular, Shifted)
            return OneSample(equiangular, placer(lit, "distance"), equiangular.domain)
    known = "equiangular, free-path, distance, uniform, mixed"
    raise InvalidValueError("placing", f"must be one of {known}", placing)
