"""Henyey-Greenstein scattering (Henyey & Greenstein 1941), in a form that holds for every g in (-1, 1), 0 included."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import UnitSphere
from fogproof.estimators.frames import Axis, directions


def density(g: float, mu: np.ndarray) -> np.ndarray:
    """Return the phase function at forward cosines mu [1/sr]; g is their mean."""
    return _density(g, 1 - mu if g >= 0 else 1 + mu)


def _density(g: float, away: np.ndarray) -> np.ndarray:
    """Return the density at `away` = 1 - mu for g >= 0, 1 + mu for g < 0: zero at the peak, where mu itself loses digits."""
    k = abs(g)
    d2 = (1 - k) ** 2 + 2 * k * away
    return (1 - k) * (1 + k) / (4 * np.pi * d2 * np.sqrt(d2))


@dataclass(frozen=True)
class HenyeyGreensteinDirections:
    """Directions about `axis`, the propagation direction before scattering.

    The textbook inverse divides by 2 g and is singular at g = 0. With k = |g| and D = 1 - k + 2 k xi it is equivalent to
    1 - mu = 2 (1 - k)^2 (1 - xi) (1 + k xi) / D^2 and 1 + mu = 2 (1 + k)^2 xi (1 - k + k xi) / D^2, sums of positive terms only.
    For g < 0 the same law is mirrored.
    """

    g: float
    axis: Axis = (0.0, 0.0, 1.0)
    domain: ClassVar[UnitSphere] = UnitSphere()
    dimensions: ClassVar[int] = 2

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 2) to directions (n, 3) and their pdf [1/sr]."""
        k = abs(self.g)
        xi = u[:, 0] if self.g >= 0 else 1 - u[:, 0]
        d2 = ((1 - k) + 2 * k * xi) ** 2
        from_peak = 2 * (1 - k) ** 2 * (1 - xi) * (1 + k * xi) / d2
        from_antipode = 2 * (1 + k) ** 2 * xi * ((1 - k) + k * xi) / d2
        versine, coversine = (from_peak, from_antipode) if self.g >= 0 else (from_antipode, from_peak)
        return Draw(directions(self.axis, versine, coversine, u[:, 1]), _density(self.g, from_peak))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of directions x (n, 3) [1/sr], from the chord to the peak: 2 (1 - mu) = |x - axis|^2."""
        peak = np.copysign(1.0, self.g) * np.asarray(self.axis)
        chord = x - peak
        return _density(self.g, 0.5 * np.sum(chord * chord, axis=-1))
