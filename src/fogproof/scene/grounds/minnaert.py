"""The ground of Minnaert 1941, darker or as bright where it is seen at a grazing angle."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.validate import number


@dataclass(frozen=True)
class MinnaertGround:
    """A ground of BRDF albedo (k + 1)/(2 pi) (mu0 mu)^(k - 1) [1/sr]; it reflects the share albedo mu0^(k - 1).

    albedo    share that it reflects of light from straight above, in [0, 1]
    exponent  k in [1, 100]; 1 is Lambert's. Below 1 more than all would be reflected at grazing angles

    Source: Minnaert 1941, The reciprocity principle in lunar photometry, Astrophysical Journal 93.
    """

    albedo: float
    exponent: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "albedo", number("albedo", self.albedo, "must lie in [0, 1]", 0, 1))
        object.__setattr__(self, "exponent", number("exponent", self.exponent, "must lie in [1, 100]", 1, 100))
