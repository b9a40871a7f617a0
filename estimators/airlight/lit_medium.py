"""A medium, the ray that looks through it, and a light: what every estimator of single scattering is built on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import get_args

import numpy as np

from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators.airlight.lighting import Illumination, LightSampler, illumination, met, sampler, towards
from fogproof.estimators.airlight.occlusion import lit
from fogproof.estimators.airlight.shadow_rays import ShadowRays, shadow_transmittance
from fogproof.estimators.airlight.shapes import through
from fogproof.estimators.free_paths.extinction import Extinction, along
from fogproof.estimators.free_paths.fog import everywhere, shares
from fogproof.estimators.media import ROOM
from fogproof.estimators.media.sources import sources_at
from fogproof.estimators.phase.functions import phase_value
from fogproof.estimators.phase.varying import phase_value_at
from fogproof.scene import AnyMedium, PhaseFunction, Ray
from fogproof.scene.kinds import given
from fogproof.scene.lights import Light
from fogproof.scene.media import sources_vary
from fogproof.scene.occluders import Occluder
from fogproof.scene.phase import constant_phase
from fogproof.scene.shapes import EVERYWHERE, Shape


@dataclass(frozen=True, eq=False)
class LitMedium:
    """The setting of one camera ray; all of it grey.

    medium       any kind; `albedo` and `phase` are for those who need them the same everywhere
    ray          one ray
    light        any light; an environment only where that is said
    occluders    between the light and the ray; the camera sees past them
    shape        convex region that a homogeneous medium fills
    shadow_rays  how the transmittance to the light is found, see `shadow_rays`
    """

    medium: AnyMedium
    ray: Ray
    light: Light
    occluders: tuple[Occluder, ...] = ()
    shape: Shape = EVERYWHERE
    shadow_rays: ShadowRays = "exact"

    def __post_init__(self) -> None:
        if self.ray.shape:
            raise UnsupportedError(f"an estimator looks along one ray, got a batch of shape {self.ray.shape}", "ray")
        if self.shadow_rays not in get_args(ShadowRays):
            raise InvalidValueError(
                "shadow_rays", f"must be one of {', '.join(get_args(ShadowRays))}", self.shadow_rays
            )
        if self.shape != EVERYWHERE and given(self.medium, ROOM, "uniform") is None:
            raise UnsupportedError("only a homogeneous medium fills a shape", "shape")

    @cached_property
    def start(self) -> float:
        """Where the ray enters the medium [m]."""
        return max(float(self._crossings[0]), 0.0)

    @cached_property
    def length(self) -> float:
        """How far it goes there, 0 if it misses the medium; a light with extent ends it [m]."""
        return max(min(self._crossings[1], float(self.ray.length), met(self.light, self.ray)) - self.start, 0.0)

    @cached_property
    def _crossings(self) -> tuple[float, float]:
        enter, leave = through(self.shape, self.ray.origin[:, None], self.ray.direction[:, None])
        return float(enter[0]), float(leave[0])

    @cached_property
    def extinction(self) -> Extinction:
        """Along the ray from `start`."""
        origin = self.ray.origin + self.start * self.ray.direction if self.start else self.ray.origin
        length = max(self.length, float(np.finfo(float).tiny))
        return along(self.medium, Ray(origin, self.ray.direction, length))

    @cached_property
    def albedo(self) -> float:
        """sigma_s / sigma_t."""
        everywhere(self.medium)
        return shares(self.medium)[0]

    @property
    def phase(self) -> PhaseFunction:
        """The medium's phase function, the same everywhere."""
        phase = constant_phase(self.medium.phase)
        if phase is None:
            raise UnsupportedError("the phase function must be the same everywhere", "medium.phase")
        return phase

    @cached_property
    def _illumination(self) -> Callable[[np.ndarray], Illumination]:
        return illumination(self.light, self.ray)

    def points(self, t: np.ndarray) -> np.ndarray:
        """Return the points (3, n) at distances t (n,) from `start`."""
        return self.ray.origin[:, None] + (self.start + t) * self.ray.direction[:, None]

    def seen(self, t: np.ndarray) -> np.ndarray:
        """Return the transmittance from the camera to t (n,)."""
        return np.exp(-self.extinction.depth(t))

    def scattered(self, t: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """Return the light scattered towards the camera at t, sigma_s L_s [W/(m^3 sr)], and the look-ups it took, (n,) each.

        It is exact, or an unbiased estimate if the shadow rays are tracked.
        """
        sample = sampler(self.light)
        if sample is not None:
            return self._scattered_from_extent(sample, t, rng)
        mu, distance, irradiance = self._illumination(self.start + t)
        uniform = given(self.medium, ROOM, "uniform")
        if uniform is not None and self.shape == EVERYWHERE and self.shadow_rays == "exact" and not self.occluders:
            value = self.albedo * self.extinction.sigma(t) * phase_value(self.phase, mu) * irradiance
            sigma_t = float(uniform(self.medium))
            with np.errstate(over="ignore"):  # a thickness beyond 1.8e308 is as good as inf
                return value * np.exp(-sigma_t * distance) if sigma_t > 0 else value, np.ones_like(t)
        x = self.points(t)
        w = towards(self.light, x)
        value = self._scattering(t, x, mu) * irradiance
        if self.occluders:
            value *= lit(self.occluders, x, w, distance)
        arriving, cost = self.transmittance(x, w, distance, rng)
        return value * arriving, 1 + cost

    def _scattering(self, t: np.ndarray, x: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """Return sigma_s f_p at points x (3, n), where albedo and phase function may differ from place to place [1/(m sr)]."""
        albedo = sources_at(self.medium, x.T)[0] if sources_vary(self.medium) else self.albedo
        return albedo * self.extinction.sigma(t) * phase_value_at(self.medium.phase, x, mu)

    def _scattered_from_extent(
        self, sample: LightSampler, t: np.ndarray, rng: np.random.Generator
    ) -> tuple[np.ndarray, np.ndarray]:
        """One direction to a light with extent is drawn for each place, so that each of them looks along one way."""
        x = self.points(t)
        w, distance, arriving = sample(x, rng.random((len(t), 2)))
        mu = np.clip(self.ray.direction @ w, -1, 1)
        value = self._scattering(t, x, mu) * arriving
        if self.occluders:
            value *= lit(self.occluders, x, w, distance)
        through, cost = self.transmittance(x, np.ascontiguousarray(w), distance, rng)
        return value * through, 1 + cost

    def transmittance(
        self, x: np.ndarray, w: np.ndarray, distance: np.ndarray, rng: np.random.Generator
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the transmittance from points x (3, n) of the medium along w (3, n) for `distance` (n,) [m], and look-ups."""
        _, leave = through(self.shape, x, w)
        return shadow_transmittance(self.shadow_rays, self.medium, x, w, np.clip(leave, 0, distance), rng)
