"""Rayleigh scattering of unpolarised light (Rayleigh 1871): 3/(16 pi) (1 + mu^2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import UnitSphere
from fogproof.estimators.frames import Axis, directions


def density(mu: np.ndarray) -> np.ndarray:
    """Return the phase function at forward cosines mu [1/sr]."""
    return 3 / (16 * np.pi) * (1 + mu * mu)


@dataclass(frozen=True)
class RayleighDirections:
    """Directions about `axis`: the cdf (mu^3 + 3 mu + 4) / 8 is inverted by the real root of a depressed cubic."""

    axis: Axis = (0.0, 0.0, 1.0)
    domain: ClassVar[UnitSphere] = UnitSphere()
    dimensions: ClassVar[int] = 2

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 2) to directions (n, 3) and their pdf [1/sr]."""
        mu = np.clip(2 * np.sinh(np.arcsinh(4 * u[:, 0] - 2) / 3), -1, 1)
        return Draw(directions(self.axis, 1 - mu, 1 + mu, u[:, 1]), density(mu))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of directions x (n, 3) [1/sr]."""
        return density(x @ np.asarray(self.axis))
