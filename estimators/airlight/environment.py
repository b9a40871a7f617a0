"""Single scattering of light from all around: one place on the camera ray, and M directions drawn there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import InvalidValueError
from fogproof.estimators.airlight.lit_medium import LitMedium
from fogproof.estimators.airlight.placing import Placer, placer
from fogproof.estimators.blocks import blocks
from fogproof.estimators.grey import grey
from fogproof.estimators.phase.directions import Directions
from fogproof.estimators.phase.functions import phase_value
from fogproof.scene import Medium, PhaseFunction, Ray
from fogproof.scene.lights import Environment
from fogproof.scene.shapes import Shape


@dataclass(frozen=True, eq=False)
class EnvironmentAirlight:
    """T(camera, x) sigma_s / p(t) times the mean of f_p(w_j) L T(x, w_j) / p(w_j) over M directions w_j.

    medium      homogeneous and grey, filling `shape`
    directions  M, how many are drawn at each place
    proposal    the phase function whose directions are drawn about the ray; None for the medium's own, and no weight

    The place is drawn by the free path that ends in the medium.
    """

    medium: Medium
    ray: Ray
    light: Environment
    shape: Shape
    directions: int = 1
    proposal: PhaseFunction | None = None

    def __post_init__(self) -> None:
        if isinstance(self.directions, bool) or not isinstance(self.directions, int) or self.directions < 1:
            raise InvalidValueError("directions", "must be a whole number >= 1", self.directions)

    @cached_property
    def _lit(self) -> LitMedium:
        return LitMedium(self.medium, self.ray, self.light, (), self.shape)

    @cached_property
    def _placer(self) -> Placer:
        return placer(self._lit, "distance")

    @cached_property
    def _sampler(self) -> Directions:
        return Directions(self.proposal or self.medium.phase, tuple(self.ray.direction.tolist()))

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance [W/(m^2 sr)], each at the cost of M directions looked along."""
        value = np.zeros(n)
        for block in blocks(n if self._lit.length > 0 else 0):
            value[block] = self._some(rng, len(value[block]))
        return Draws(value, np.full(n, float(self.directions)))

    def _some(self, rng: np.random.Generator, n: int) -> np.ndarray:
        lit = self._lit
        places = self._placer.sample(rng.random((n, 1)))
        assert places.pdf is not None
        x = lit.points(places.x)
        arriving = np.zeros(n)
        for _ in range(self.directions):
            drawn = self._sampler.sample(rng.random((n, 2)))
            w = np.ascontiguousarray(drawn.x.T)
            through, _ = lit.transmittance(x, w, np.full(n, np.inf), rng)
            arriving += self._weight(drawn.weight, drawn.pdf, w) * through
        scattered = lit.albedo * lit.extinction.sigma(places.x) * grey("radiance", self.light.radiance) * arriving
        return lit.seen(places.x) * scattered / (self.directions * places.pdf)

    def _weight(self, weight: np.ndarray | None, pdf: np.ndarray | None, w: np.ndarray) -> np.ndarray | float:
        """Return f_p / p of directions w (3, n)."""
        if self.proposal is None:
            return 1.0 if weight is None else weight
        mu = np.clip(self.ray.direction @ w, -1, 1)
        assert pdf is not None
        return phase_value(self.medium.phase, mu) / pdf
