"""An estimator made for one scene: it has a part for each term of the volume rendering equation that the scene needs.

    L = T L_bg + int T (sigma_a L_e + sigma_s L_i) dt + int T sigma_s L_s dt

Where the sources are the same everywhere, the first two terms are T L_bg + (1 - T) source, linear in T: exact where T has a
closed form, and unbiased with any unbiased estimate of T. The last one is a single scattering event on the ray.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.capabilities import capabilities, emits, scatters
from fogproof.contracts import Draws, Estimator
from fogproof.errors import UnsupportedError
from fogproof.estimators import (
    Airlight,
    RatioTransmittance,
    RegularTransmittance,
    along,
    delta_tracking,
)
from fogproof.estimators.free_paths.fog import source_per_collision
from fogproof.estimators.media.sources import sources_at
from fogproof.estimators.tracking.tracked import clip_to_box
from fogproof.plan import plan
from fogproof.scene import AnyMedium, Ray, Scene
from fogproof.scene.lights import Light
from fogproof.scene.media import box
from fogproof.scene.one_channel import one_channel


@dataclass(frozen=True, eq=False)
class SceneEstimator:
    """The radiance of a scene as the sum of parts, by the names of the terms they stand for; no part, no light, no work."""

    parts: dict[str, Estimator]

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance [W/(m^2 sr)], at the cost of all their look-ups."""
        drawn = [part.draw(rng, n) for part in self.parts.values()]
        if not drawn:
            return Draws(np.zeros(n), np.zeros(n))
        value, cost = drawn[0].value, drawn[0].cost
        for draws in drawn[1:]:
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

    medium: AnyMedium
    ray: Ray
    ambient: float
    background: float

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance [W/(m^2 sr)]."""
        rays = Ray(np.tile(self.ray.origin, (n, 1)), np.tile(self.ray.direction, (n, 1)), np.full(n, self.ray.length))
        paths = delta_tracking(self.medium, rays, rng)
        collided = paths.event == 0
        x = self.ray.origin + paths.distance[collided, None] * self.ray.direction
        albedo, emission = sources_at(self.medium, x)
        value = np.full(n, self.background)
        value[collided] = albedo * self.ambient + (1 - albedo) * emission
        return Draws(value, paths.cost)


def estimator_for(scene: Scene) -> SceneEstimator | ColouredSceneEstimator:
    """Return the cheapest unbiased estimator of what the camera sees along one ray, see `plan`.

    It draws radiances [W/(m^2 sr)], (n,), or (n, channels) of a coloured scene, whose mean is `analytic.radiance(scene)`; without
    variance where nothing is random. Shadow rays are exact or by ratio tracking, never marched. A scene that cannot be followed is
    refused in the words of its plan.
    """
    if scene.ray.shape:
        raise UnsupportedError(f"an estimator looks along one ray, got a batch of shape {scene.ray.shape}", "ray")
    refused = capabilities(scene).refused
    if refused:
        raise UnsupportedError(refused, "scene")
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
    how, ray = capabilities(scene), _ended(scene.medium, scene.ray)
    if ray is None or (
        how.placing == "distance" and not along(scene.medium, ray).depth(np.array(float(ray.length))) > 0
    ):
        return Unattenuated(0.0)  # nothing on the ray scatters
    return Airlight(scene.medium, ray, light, how.placing, scene.occluders, shadow_rays=how.shadow_rays)


def _ended(medium: AnyMedium, ray: Ray) -> Ray | None:
    """Return an endless ray up to where it leaves the medium's box, if that ends; None if it misses it."""
    if np.isfinite(ray.length) or not np.isfinite(box(medium)).all():
        return ray
    _, leave = clip_to_box(ray.origin[None], ray.direction[None], ray.length[None], *box(medium))
    return Ray(ray.origin, ray.direction, float(leave[0])) if leave[0] > 0 else None


def _direct(scene: Scene, attenuated: bool) -> Estimator:
    medium, ray, background = scene.medium, scene.ray, float(np.asarray(scene.background))
    ambient = float(np.asarray(scene.ambient)) if scene.scattering == "ambient" else 0.0
    if not attenuated:
        return Unattenuated(background)
    how = capabilities(scene)
    if how.sources == "collision" and (emits(medium) or (ambient > 0 and scatters(medium))):
        return LookedUpSource(medium, ray, ambient, background)
    source = source_per_collision(medium, ambient) if how.sources == "lerp" else 0.0
    return Lerp(_THROUGH[how.camera_rays](medium, ray), background, source)


_THROUGH: dict[str, Callable[[Any, Ray], Estimator]] = {
    "closed": ClosedTransmittance,
    "cells": RegularTransmittance,
    "ratio": RatioTransmittance,
}
