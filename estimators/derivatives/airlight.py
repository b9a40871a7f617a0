"""Derivatives of single scattering of a point light in a homogeneous medium, by sigma_a, sigma_s and g.

Distances drawn from the free path depend on the coefficients themselves, so their density has a derivative of its own: the
score. Distances drawn uniformly do not, and the integrand is differentiated alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import InvalidValueError
from fogproof.estimators.phase.functions import phase_value
from fogproof.scene import Medium, PointLight, Ray
from fogproof.scene.kinds import given

PHASES = "fogproof.estimators.phase"


@dataclass(frozen=True, eq=False)
class AirlightSlopes:
    """One point of the ray, lit by the lamp: the derivatives of its contribution.

    medium    sigma_a, sigma_s > 0, grey, with a Henyey-Greenstein phase function
    ray       one camera ray of finite length
    light     a point light
    distances  where points come from
    """

    medium: Medium
    ray: Ray
    light: PointLight
    distances: Literal["free_path", "uniform"] = "free_path"

    def __post_init__(self) -> None:
        if given(self.medium.phase, PHASES, "asymmetry_score") is None or not np.all(
            np.asarray(self.medium.sigma_s) > 0
        ):
            raise InvalidValueError(
                "medium", "must scatter, with a phase function that has an asymmetry_score", self.medium
            )

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, 3) of the derivatives by sigma_a, sigma_s and g."""
        value, score, toward, mu = self.pieces(rng, n)
        sigma_t, sigma_s = float(self.medium.sigma_t), float(np.asarray(self.medium.sigma_s))
        # A free path's density stands in the denominator, and its score brings it back; a uniform distance has none.
        by_t = (score - 1 / sigma_t if self.distances == "free_path" else -score) - toward
        by_g = given(self.medium.phase, PHASES, "asymmetry_score")(self.medium.phase, mu)
        return Draws(value[:, None] * np.stack([by_t, by_t + 1 / sigma_s, by_g], axis=1))

    def pieces(self, rng: np.random.Generator, n: int) -> tuple[np.ndarray, ...]:
        """Return contributions, the score of the distance (or the distance itself), the way to the lamp and the cosine."""
        length, sigma_t = float(self.ray.length), float(self.medium.sigma_t)
        free = self.distances == "free_path"
        t = rng.standard_exponential(n) / sigma_t if free else length * rng.random(n)
        inside = t < length
        t = np.where(inside, t, 0.0)
        apart = np.asarray(self.light.position) - (self.ray.origin + t[:, None] * self.ray.direction)
        r = np.linalg.norm(apart, axis=1)
        mu = apart @ self.ray.direction / r
        scatters = (
            float(np.asarray(self.medium.sigma_s))
            * phase_value(self.medium.phase, mu)
            * float(np.asarray(self.light.intensity))
        )
        lit = scatters * np.exp(-sigma_t * r) / (r * r)
        value = np.where(inside, lit / sigma_t if free else lit * length * np.exp(-sigma_t * t), 0.0)
        return value, (1 / sigma_t - t) if free else t, r, mu
