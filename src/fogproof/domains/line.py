"""The real line and its parts.

Unbounded lines have a known law with tails as heavy as those of the pilot at least: the log-logistic law, whose cdf is a rational
function of a power, F(t) = t^b / (1 + t^b) of the distance t from the end or the centre in units of the median.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fogproof.domains.law import Law, at_the_ends
from fogproof.errors import InvalidValueError
from fogproof.validate import number

_LEAST_INDEX = 0.02  # of a tail: a power less is not told from it in floating point
_QUARTILES = 2 * math.log(3.0)  # distance of the quartiles of log t, times b
_CLOSE = 2.0**-30  # of the distance of the quartiles: so near to 0
_CROWD = 2.0**-10  # of the points lie if there is a pole
_FAR = (1 - 2.0**-8, 1 - 2.0**-10)  # shares of the points below two places, whose distance in log t tells the tail


@dataclass(frozen=True)
class Tail:
    """The log-logistic law of a distance t >= 0: scale m, index b <= 1."""

    m: float = 1.0
    b: float = 1.0

    @staticmethod
    def of(t: np.ndarray) -> Tail:
        """Return the law with the median and, in logarithms, at least the spread of the distances t (n,), near it and far out.

        A bulk may be narrow and its tail heavy all the same: a lighter law would not come near the last of its mass.
        """
        t = t[np.isfinite(t) & (t > 0)]
        if len(t) < 4:
            return Tail()
        low, middle, high, far, farther = np.quantile(np.log(t), [0.25, 0.5, 0.75, *_FAR])
        index = min(1.0, _QUARTILES / max(high - low, _QUARTILES), np.log(4.0) / max(farther - far, np.log(4.0)))
        return Tail(float(np.exp(middle)), max(float(index), _LEAST_INDEX))

    def cdf(self, t: np.ndarray) -> np.ndarray:
        """Return F(t)."""
        with np.errstate(over="ignore", divide="ignore"):
            return np.asarray(1 / (1 + (t / self.m) ** -self.b))

    def survival(self, t: np.ndarray) -> np.ndarray:
        """Return 1 - F(t), without loss where it is small."""
        with np.errstate(over="ignore", divide="ignore"):
            return np.asarray(1 / (1 + (t / self.m) ** self.b))

    def quantile(self, u: np.ndarray) -> np.ndarray:
        """Return t with F(t) = u; numbers beyond the largest double become it."""
        return self._at_odds(u, 1 - u)

    def survived(self, u: np.ndarray) -> np.ndarray:
        """Return t with 1 - F(t) = u, the same."""
        return self._at_odds(1 - u, u)

    def _at_odds(self, below: np.ndarray, beyond: np.ndarray) -> np.ndarray:
        with np.errstate(over="ignore", divide="ignore"):
            return np.asarray(np.minimum(self.m * (below / beyond) ** (1 / self.b), np.finfo(float).max))

    def density(self, t: np.ndarray) -> np.ndarray:
        """Return F'(t), finite at t = 0 because a distance is no smaller than the smallest normal number."""
        with np.errstate(over="ignore", under="ignore"):
            s = np.maximum(t / self.m, np.finfo(float).tiny)
            power = s**-self.b
            return np.asarray(self.b / (self.m * s * (1 + power) * (1 + 1 / power)))


def _typical(t: np.ndarray) -> float:
    """Return the lower quartile of the distances t that are positive, 0 where most are not: the size of what has no other."""
    t = t[np.isfinite(t)]
    positive = t[t > 0]
    return float(np.quantile(positive, 0.25, method="lower")) if len(t) and 2 * len(positive) >= len(t) else 0.0


def centre(pilot: np.ndarray) -> float:
    """Return about where coordinates of the real line lie on both sides: the median of the points (n,), or 0 if they crowd there.

    Numbers lie closer around 0 than anywhere else, and coordinates about their centre alone follow them.
    """
    if len(pilot) == 0:
        return 0.0
    low, middle, high = np.quantile(pilot, [0.25, 0.5, 0.75])
    crowd = (pilot != 0) & (np.abs(pilot) <= _CLOSE * (high - low))
    return 0.0 if np.mean(crowd) > _CROWD else float(middle)


@dataclass(frozen=True)
class Interval:
    """The interval [a, b], both ends finite; the pdf is per unit length."""

    a: float
    b: float

    shape = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "a", number("a", self.a, "must be finite", fix="use HalfLine or RealLine"))
        object.__setattr__(self, "b", number("b", self.b, "must be finite", fix="use HalfLine or RealLine"))
        if not self.a < self.b:
            raise InvalidValueError("b", f"must be greater than a = {self.a}", self.b)
        if not math.isfinite(self.b - self.a):
            raise InvalidValueError("b", f"must be so near a = {self.a} that b - a is finite", self.b, "use RealLine")

    @property
    def measure(self) -> float:
        """The length."""
        return self.b - self.a

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which numbers lie between the ends."""
        scale, length = max(abs(self.a), abs(self.b)), self.b - self.a
        room = max(slack * scale, at_the_ends(slack) * length)
        return np.isfinite(x) & (x >= self.a - room) & (x <= self.b + room)

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law."""
        a, length = self.a, self.b - self.a
        return Law(
            ("x",),
            lambda u: a + length * u[:, 0],
            lambda x, v: np.clip((x - a) / length, 0.0, 1.0)[:, None],
            lambda x: np.full(len(x), 1 / length),
        )


@dataclass(frozen=True)
class HalfLine:
    """The half line [a, inf); the pdf is per unit length."""

    a: float = 0.0

    shape = ()
    measure = math.inf

    def __post_init__(self) -> None:
        object.__setattr__(self, "a", number("a", self.a, "must be finite", fix="use RealLine"))

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which numbers are finite and no less than a; the domain's size is |a|, or that of the distances x - a."""
        size = max(abs(self.a), _typical(x - self.a))
        return np.isfinite(x) & (x >= self.a - at_the_ends(slack) * size)

    def law(self, pilot: np.ndarray) -> Law:
        """Return a log-logistic law of the distance from a."""
        a, tail = self.a, Tail.of(pilot - self.a)
        return Law(
            ("x",),
            lambda u: a + tail.quantile(u[:, 0]),
            lambda x, v: tail.cdf(np.maximum(x - a, 0.0))[:, None],
            lambda x: tail.density(np.maximum(x - a, 0.0)),
        )


@dataclass(frozen=True)
class RealLine:
    """All real numbers; the pdf is per unit length."""

    shape = ()
    measure = math.inf

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which numbers are finite."""
        return np.isfinite(x)

    def law(self, pilot: np.ndarray) -> Law:
        """Return a log-logistic law of the distance from the centre of the pilot, on both sides alike.

        Far to the left coordinates are as fine as numbers near 0, far to the right as those near 1.
        """
        middle = centre(pilot)
        tail = Tail.of(np.abs(pilot - middle))

        def place(u: np.ndarray) -> np.ndarray:
            left = u[:, 0] < 0.5
            t = tail.survived(2 * np.where(left, u[:, 0], 1 - u[:, 0]))
            return middle + np.where(left, -t, t)

        def coordinates(x: np.ndarray, v: np.ndarray) -> np.ndarray:
            beyond = 0.5 * tail.survival(np.abs(x - middle))
            return np.where(x < middle, beyond, 1 - beyond)[:, None]

        return Law(("x",), place, coordinates, lambda x: 0.5 * tail.density(np.abs(x - middle)))
