"""An estimator made for one scene: it has a part for each term of the volume rendering equation that the scene needs.

    L = T L_bg + int T (sigma_a L_e + sigma_s L_i) dt + int T sigma_s L_s dt

Where the sources are the same everywhere, the first two terms are T L_bg + (1 - T) source, linear in T: exact where T has a
closed form, and unbiased with any unbiased estimate of T. The last one is a single scattering event on the ray.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.contracts import Draws, Estimator
from fogproof.errors import UnsupportedError
from fogproof.estimators import (
    Airlight,
    RatioTransmittance,
    RegularTransmittance,
    along,
    delta_tracking,
)
from fogproof.estimators.airlight.placing import Placing
from fogproof.estimators.airlight.shadow_rays import ShadowRays
from fogproof.estimators.free_paths.fog import source_per_collision
from fogproof.plan import plan
from fogproof.scene import AnyMedium, ExponentialMedium, LinearMedium, Medium, Procedural, Ray, Scene, VoxelGrid
from fogproof.scene.lights import Light
from fogproof.scene.one_channel import one_channel


@dataclass(frozen=True, eq=False)
class SceneEstimator:
    """The radiance of a scene as the sum of parts, by the names of the terms they stand for; no part, no light, no work."""

    parts: dict[str, Estimator]

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance [W/(m^2 sr)], at the cost of all their look-ups."""
        value, cost = np.zeros(n), np.zeros(n)
        for part in self.parts.values():
            draws = part.draw(rng, n)
            value, cost = value + draws.value, cost + draws.cost
        return Draws(value, cost)


@dataclass(frozen=True, eq=False)
class ColouredSceneEstimator:
    """A grey estimator for each channel; channels that see the same scene are equal in distribution, not draw by draw."""

    channels: tuple[SceneEstimator, ...]

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, channels) of the radiance [W/(m^2 sr)], at the cost of all their look-ups."""
        drawn = [channel.draw(rng, n) for channel in self.channels]
        return Draws(np.stack([d.value for d in drawn], axis=-1), np.sum([np.asarray(d.cost) for d in drawn], axis=0))


@dataclass(frozen=True, eq=False)
class ClosedTransmittance:
    """Transmittance along one ray of a grey medium in closed form: no random number, one look-up."""

    medium: AnyMedium
    ray: Ray

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n times the same value."""
        depth = along(self.medium, self.ray).depth(np.array(float(self.ray.length)))
        return Draws(np.full(n, float(np.exp(-depth))), np.ones(n))


@dataclass(frozen=True, eq=False)
class Lerp:
    """source + T (background - source), with one estimate of T a realisation."""

    through: Estimator
    background: float
    source: float

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance [W/(m^2 sr)]."""
        draws = self.through.draw(rng, n)
        return Draws(self.source + draws.value * (self.background - self.source), draws.cost)


@dataclass(frozen=True, eq=False)
class Unattenuated:
    """A radiance that nothing stands in the way of."""

    radiance: float

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n times the same value, at no cost."""
        return Draws(np.full(n, self.radiance), np.zeros(n))


@dataclass(frozen=True, eq=False)
class LookedUpSource:
    """Sources that vary along the ray: a path that collides looks albedo and emission up there, any other sees the background."""

    medium: Procedural
    ray: Ray
    ambient: float
    background: float

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance [W/(m^2 sr)]."""
        rays = Ray(np.tile(self.ray.origin, (n, 1)), np.tile(self.ray.direction, (n, 1)), np.full(n, self.ray.length))
        paths = delta_tracking(self.medium, rays, rng)
        collided = paths.event == 0
        x = self.ray.origin + paths.distance[collided, None] * self.ray.direction
        albedo, emission = _at(self.medium.albedo, x), _at(self.medium.emission, x)
        value = np.full(n, self.background)
        value[collided] = albedo * self.ambient + (1 - albedo) * emission
        return Draws(value, paths.cost)


def estimator_for(scene: Scene) -> SceneEstimator | ColouredSceneEstimator:
    """Return the cheapest unbiased estimator of what the camera sees along one ray, see `plan`.

    It draws radiances [W/(m^2 sr)], (n,), or (n, channels) of a coloured scene, whose mean is `analytic.radiance(scene)`; without
    variance where nothing is random. Shadow rays are exact or by ratio tracking, never marched.
    """
    if scene.ray.shape:
        raise UnsupportedError(f"an estimator looks along one ray, got a batch of shape {scene.ray.shape}", "ray")
    if scene.channels is not None:
        return ColouredSceneEstimator(tuple(_grey(one_channel(scene, c)) for c in range(scene.channels)))
    return _grey(scene)


def _grey(scene: Scene) -> SceneEstimator:
    kept = {term.name for term in plan(scene).terms if term.kept}
    parts: dict[str, Estimator] = {}
    if kept & {"background", "emission"} or (scene.scattering == "ambient" and "in-scattering" in kept):
        parts["background, emission and ambient"] = _direct(scene, "attenuation" in kept)
    if scene.scattering == "single" and "in-scattering" in kept:
        assert scene.light is not None
        parts["in-scattering"] = _airlight(scene, scene.light)
    return SceneEstimator(parts)


def _airlight(scene: Scene, light: Light) -> Estimator:
    closed = isinstance(scene.medium, Medium | LinearMedium | ExponentialMedium)
    shadow_rays: ShadowRays = "exact" if closed or isinstance(scene.medium, VoxelGrid) else "ratio"
    placing: Placing = "equiangular"
    if light.distant:
        placing = "distance" if closed else "uniform"
    return Airlight(scene.medium, scene.ray, light, placing, scene.occluders, shadow_rays=shadow_rays)


def _direct(scene: Scene, attenuated: bool) -> Estimator:
    medium, ray, background = scene.medium, scene.ray, float(np.asarray(scene.background))
    ambient = float(np.asarray(scene.ambient)) if scene.scattering == "ambient" else 0.0
    if not attenuated:
        return Unattenuated(background)
    if isinstance(medium, Procedural) and (callable(medium.albedo) or callable(medium.emission)):
        return LookedUpSource(medium, ray, ambient, background)
    return Lerp(_through(medium, ray), background, source_per_collision(medium, ambient))


def _through(medium: AnyMedium, ray: Ray) -> Estimator:
    match medium:
        case Procedural():
            return RatioTransmittance(medium, ray)
        case VoxelGrid():
            return RegularTransmittance(medium, ray)
    return ClosedTransmittance(medium, ray)


def _at(value: Any, x: np.ndarray) -> np.ndarray:
    return np.broadcast_to(value(x) if callable(value) else value, (len(x),))
