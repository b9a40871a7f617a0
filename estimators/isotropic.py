"""Isotropic scattering: all directions alike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import UnitSphere
from fogproof.estimators.frames import Axis, directions


def density(mu: np.ndarray) -> np.ndarray:
    """Return the phase function at forward cosines mu [1/sr]."""
    return np.full_like(mu, 0.25 / np.pi)


@dataclass(frozen=True)
class IsotropicDirections:
    """Directions uniform on the sphere (Archimedes: the cosine to any axis is uniform)."""

    axis: Axis = (0.0, 0.0, 1.0)
    domain: ClassVar[UnitSphere] = UnitSphere()
    dimensions: ClassVar[int] = 2

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 2) to directions (n, 3) and their pdf [1/sr]."""
        x = directions(self.axis, 2 * (1 - u[:, 0]), 2 * u[:, 0], u[:, 1])
        return Draw(x, self.pdf(x))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of directions x (n, 3) [1/sr]."""
        return np.full(len(x), 0.25 / np.pi)
