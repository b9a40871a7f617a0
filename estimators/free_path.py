"""Free paths in a homogeneous medium, up to a surface: a density before it, a probability at it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import HalfLine, Interval
from fogproof.errors import InvalidValueError
from fogproof.validate import number


@dataclass(frozen=True)
class HomogeneousFreePath:
    """Distance to the next event: a collision at t < `surface`, or the surface itself.

    sigma_t  extinction coefficient [1/m]
    surface  distance of the surface [m], inf if there is none

    Collisions have the *density* sigma_t e^{-sigma_t t} [1/m]; the surface is reached with *probability* e^{-sigma_t surface}, an
    atom. Event 0 is a collision, 1 the surface.
    """

    sigma_t: float
    surface: float = np.inf
    dimensions: ClassVar[int] = 1

    def __post_init__(self) -> None:
        number("sigma_t", self.sigma_t, "must be finite and >= 0 [1/m]", 0)
        if not self.surface > 0:
            raise InvalidValueError("surface", "must be > 0 [m]", self.surface, "inf means that there is none")

    @property
    def domain(self) -> Interval | HalfLine:
        """[0, surface], or the half line."""
        return HalfLine(0.0) if np.isinf(self.surface) else Interval(0.0, self.surface)

    @property
    def atoms(self) -> dict[float, float]:
        """The probability of reaching the surface (at inf: of never colliding, which only an empty medium allows)."""
        if np.isinf(self.surface):
            return {np.inf: 1.0} if self.sigma_t == 0 else {}
        return {self.surface: float(np.exp(-self.sigma_t * self.surface))}

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to distances [m] and their density [1/m], or probability where the surface is reached."""
        depth = -np.log1p(-u[:, 0])  # optical depth to the collision; finite for every u in [0, 1)
        t = depth / self.sigma_t if self.sigma_t > 0 else np.full_like(depth, np.inf)
        hit = t >= self.surface
        x = np.where(hit, self.surface, t)
        at_surface = self.atoms.get(self.surface, 0.0)
        return Draw(x, np.where(hit, at_surface, self.sigma_t * (1 - u[:, 0])), event=hit.astype(np.int64))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of collisions at distances x (n,) [1/m]."""
        return self.sigma_t * np.exp(-self.sigma_t * x)
