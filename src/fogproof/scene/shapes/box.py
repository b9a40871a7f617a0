"""The box along the axes."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.errors import InvalidValueError
from fogproof.validate import one_point


@dataclass(frozen=True)
class Box:
    """The points of a box along the axes.

    lower, upper  (x, y, z) corners [m]
    """

    lower: tuple[float, float, float]
    upper: tuple[float, float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "lower", one_point("lower", self.lower))
        object.__setattr__(self, "upper", one_point("upper", self.upper))
        if not all(low < high for low, high in zip(self.lower, self.upper, strict=True)):
            raise InvalidValueError("upper", f"must be above lower = {self.lower} on each axis", self.upper)

    @property
    def bounds(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Its own corners [m]."""
        return self.lower, self.upper
