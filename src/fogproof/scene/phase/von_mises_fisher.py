"""The von Mises-Fisher distribution of directions (Fisher 1953)."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.scene.phase.phase_function import PhaseFunction
from fogproof.validate import number

SHARPEST = 1e15


@dataclass(frozen=True)
class VonMisesFisher(PhaseFunction):
    """f(mu) = kappa exp(kappa mu)/(4 pi sinh kappa): the normal distribution of the sphere (Fisher 1953).

    kappa  concentration in [-1e15, 1e15]: > 0 scatters forward, < 0 backward, 0 is isotropic

    The mean cosine is coth kappa - 1/kappa; a narrow peak has the standard deviation kappa^(-1/2) [rad] on either axis.
    """

    kappa: float

    def __post_init__(self) -> None:
        rule, fix = "must lie in [-1e15, 1e15]", "a narrower peak is a delta, which has no density"
        object.__setattr__(self, "kappa", number("kappa", self.kappa, rule, -SHARPEST, SHARPEST, fix=fix))
