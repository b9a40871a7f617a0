"""The ground that reflects equally into all directions."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.validate import number


@dataclass(frozen=True)
class LambertGround:
    """A ground of BRDF albedo/pi [1/sr].

    albedo  share of the light that it reflects, in [0, 1]
    """

    albedo: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "albedo", number("albedo", self.albedo, "must lie in [0, 1]", 0, 1))
