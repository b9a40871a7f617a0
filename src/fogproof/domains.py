"""Where samples live: the domain of a sampler and the measure its density refers to.

| domain             | point                        | measure of the pdf    |
|--------------------|------------------------------|-----------------------|
| `UnitSphere`       | (n, 3) unit vectors          | solid angle [1/sr]    |
| `UnitHemisphere`   | (n, 3) unit vectors, z >= 0  | solid angle [1/sr]    |
| `UnitDisk`         | (n, 2), x^2 + y^2 <= 1       | area                  |
| `UnitSquare`       | (n, 2) in [0, 1]^2           | area                  |
| `Interval(a, b)`   | (n,)                         | length                |
| `HalfLine(a)`      | (n,) in [a, inf)             | length                |
| `RealLine()`       | (n,)                         | length                |
| `Discrete(n)`      | (n,) integers 0 … n − 1      | counting              |
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fogproof.errors import InvalidValueError
from fogproof.validate import number


@dataclass(frozen=True)
class UnitSphere:
    """All directions; the pdf is per steradian."""


@dataclass(frozen=True)
class UnitHemisphere:
    """Directions with z >= 0; the pdf is per steradian."""


@dataclass(frozen=True)
class UnitDisk:
    """The disk x^2 + y^2 <= 1; the pdf is per unit area."""


@dataclass(frozen=True)
class UnitSquare:
    """The square [0, 1]^2; the pdf is per unit area."""


@dataclass(frozen=True)
class Interval:
    """The interval [a, b], both ends finite; the pdf is per unit length."""

    a: float
    b: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "a", number("a", self.a, "must be finite", fix="use HalfLine or RealLine"))
        object.__setattr__(self, "b", number("b", self.b, "must be finite", fix="use HalfLine or RealLine"))
        if not self.a < self.b:
            raise InvalidValueError("b", f"must be greater than a = {self.a}", self.b)


@dataclass(frozen=True)
class HalfLine:
    """The half line [a, inf); the pdf is per unit length."""

    a: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "a", number("a", self.a, "must be finite", fix="use RealLine"))


@dataclass(frozen=True)
class RealLine:
    """All real numbers; the pdf is per unit length."""


@dataclass(frozen=True)
class Discrete:
    """The integers 0 … n − 1; the pdf is a probability."""

    n: int

    def __post_init__(self) -> None:
        if isinstance(self.n, bool) or not isinstance(self.n, int) or self.n < 1:
            raise InvalidValueError("n", "must be a whole number >= 1", self.n)


Domain = UnitSphere | UnitHemisphere | UnitDisk | UnitSquare | Interval | HalfLine | RealLine | Discrete


def support(domain: Domain) -> tuple[float, float]:
    """Return the ends of a one-dimensional domain."""
    match domain:
        case Interval(a, b):
            return a, b
        case HalfLine(a):
            return a, math.inf
        case RealLine():
            return -math.inf, math.inf
    raise InvalidValueError("domain", "must be Interval, HalfLine or RealLine", domain)
