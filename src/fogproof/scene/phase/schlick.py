"""Schlick's rational stand-in for Henyey-Greenstein."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.errors import InvalidValueError
from fogproof.scene.phase.phase_function import PhaseFunction, asymmetry
from fogproof.validate import number


@dataclass(frozen=True)
class Schlick(PhaseFunction):
    """Schlick's rational stand-in for Henyey-Greenstein (Blasi, Le Saec & Schlick 1993), |k| < 1.

    Its mean cosine is about 2k/3 for small k; it is not the g of a Henyey-Greenstein function, however k was found.
    """

    k: float

    def __post_init__(self) -> None:
        rule, fix = "must lie in the open interval (-1, 1)", "beyond it the formula is not a density"
        object.__setattr__(self, "k", number("k", self.k, rule, -1, 1, open_ends=True, fix=fix))

    @classmethod
    def from_g(cls, g: float) -> Schlick:
        """Return the function with k = 1.55 g - 0.55 g^3, which looks like Henyey-Greenstein with this g.

        The fit is for moderate g: it exceeds 1 for 0.9381 < |g| < 1, where it is refused, and the mean cosine of the
        result is not g (0.8726 for g = 0.8).
        """
        g = asymmetry("g", g)
        k = 1.55 * g - 0.55 * g**3
        if not abs(k) < 1:
            fix = f"here k = {k:.6g}, which is no density: give Schlick(k) directly"
            raise InvalidValueError("g", "must keep |1.55 g - 0.55 g^3| below 1, that is |g| < 0.9381", g, fix)
        return cls(k)
