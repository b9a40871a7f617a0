"""Decoupled ray marching (Kulla & Fajardo 2012): the transmittance is marched once and cached, then the in-scattering sampled.

Any number of samples share the march. The cached transmittance serves twice: to weigh the samples, and as a table to draw them
from, which follows sigma_t T where it varies; equiangular sampling follows the light. A coin chooses between the two, and the
density is the mean of both.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from fogproof.contracts import Draw, Draws
from fogproof.domains import Interval
from fogproof.errors import UnsupportedError
from fogproof.estimators.airlight.lit_medium import LitMedium
from fogproof.estimators.airlight.placing import OneSample, Placer, Shifted, placer
from fogproof.estimators.airlight.shadow_rays import ShadowRays
from fogproof.estimators.airlight.single_scattering import one_sample
from fogproof.estimators.tracking.marching import RayMarch
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.lights import Light
from fogproof.scene.occluders import Occluder
from fogproof.validate import number


@dataclass(frozen=True, eq=False)
class CachedTransmittance:
    """What a march along one ray has cached: constant extinction in each step. As a sampler, collisions that are sure to happen."""

    march: RayMarch
    dimensions: ClassVar[int] = 1

    @property
    def domain(self) -> Interval:
        """The marched part of the ray."""
        return Interval(float(self.march.edges[0]), float(self.march.edges[-1]))

    @cached_property
    def _table(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
        """Return edges, depths at them, extinctions between them, and the probability of a collision."""
        depths = self.march.depths[:, 0]
        return self.march.edges, depths, self.march.sigma[:, 0], -float(np.expm1(-depths[-1]))

    def depth(self, t: np.ndarray) -> np.ndarray:
        """Return the optical depth to distances t (n,)."""
        edges, depths, _, _ = self._table
        return np.interp(t, edges, depths)

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to distances [m] and their density [1/m]."""
        edges, depths, _, share = self._table
        x = np.interp(-np.log1p(-share * u[:, 0]), depths, edges)
        return Draw(x, self.pdf(x))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density at distances x (n,) [1/m]."""
        edges, _, sigma, share = self._table
        step = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(sigma) - 1)
        inside = (x >= edges[0]) & (x <= edges[-1])
        return np.where(inside, sigma[step] * np.exp(-self.depth(x)) / share, 0.0)


@dataclass(frozen=True, eq=False)
class DecoupledAirlight:
    """Single scattering with the transmittance from the camera cached.

    step  of the march [m]; None for the feature size of the medium. The bias is of its square, and none where the extinction is
          constant in each step.

    The other arguments are those of `LitMedium`; the light is at a point, and the ray ends.
    """

    medium: AnyMedium
    ray: Ray
    light: Light
    step: float | None = None
    occluders: tuple[Occluder, ...] = ()
    shadow_rays: ShadowRays = "exact"
    _lit: LitMedium = field(init=False, repr=False)

    def __post_init__(self) -> None:
        number("length of the ray", self.ray.length, "must be finite [m]")
        lit = LitMedium(self.medium, self.ray, self.light, self.occluders, shadow_rays=self.shadow_rays)
        object.__setattr__(self, "_lit", lit)

    @cached_property
    def cache(self) -> CachedTransmittance:
        """The march, made once."""
        return CachedTransmittance(RayMarch(self.medium, self.ray, self.step))

    @cached_property
    def _placer(self) -> Placer:
        equiangular = placer(self._lit, "equiangular")
        assert isinstance(equiangular, Shifted)
        if not self.cache.march.depths[-1, 0] > 0:
            raise UnsupportedError("the ray meets no medium", "ray")
        return OneSample(equiangular, self.cache, equiangular.domain)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance [W/(m^2 sr)], at the cost of the look-ups made after the march."""
        return one_sample(self._lit, self._placer, lambda t: np.exp(-self.cache.depth(t)), rng, n)
