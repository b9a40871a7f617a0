"""Single scattering with an exponential of the wrong length: one of the two ways, the depth for the distance, or one taken twice.

For a lamp in a uniform medium that fills space, each variant is an integral along the ray, taken by the midpoint rule in the angle
seen from the lamp; its ratio to the right one, taken alike, turns the right airlight into the wrong.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.analytic.phase.functions import phase_values
from fogproof.images.causes.image_cause import ImageCause, Sight, fixed
from fogproof.scene import Ray
from fogproof.scene.kinds import given
from fogproof.scene.shapes import EVERYWHERE

NODES = 96

FLAT = 1e-3
"""Range of cosines to the axis below which depth and distance are the same."""


def hypotheses(sight: Sight) -> Iterator[ImageCause]:
    """Yield single scattering with wrong lengths in its exponentials, and background with depth for distance."""
    yield from _depth(sight)
    scene = sight.scene
    position = getattr(scene.light, "position", None)
    uniform = hasattr(scene.medium, "mean_free_path")
    if scene.scattering != "single" or position is None or not uniform or scene.shape != EVERYWHERE or scene.occluders:
        return
    x0, y0, _, _ = scene.camera.film.window
    rays = given(scene.camera, "fogproof.analytic.cameras", "rays")
    ray: Ray = rays(scene.camera, sight.columns + (x0 + 0.5), sight.rows + (y0 + 0.5))
    right = _airlight(sight, ray, np.array(position), 1, 1, 2)
    direct = sight.at_centres(replace(scene, scattering="none", light=None))
    airlight = sight.centres - direct
    variants = (
        ("no-way-to-the-light", (1, 0, 2), "the way from the light to the point does not attenuate"),
        ("no-way-to-the-camera", (0, 1, 2), "the way from the point to the camera does not attenuate"),
        ("no-attenuation", (0, 0, 2), "single scattering is not attenuated at all"),
        ("attenuated-twice", (2, 1, 2), "the way to the camera attenuates twice"),
        ("attenuated-twice", (1, 2, 2), "the way from the light attenuates twice"),
        ("attenuated-twice", (2, 2, 2), "both ways attenuate twice"),
        ("inverse-distance", (1, 1, 1), "light falls off with 1/r, not with 1/r^2"),
        ("inverse-distance", (1, 1, 0), "light does not fall off with distance"),
    )
    with np.errstate(all="ignore"):
        to_means = np.where(sight.centres > 0, sight.reference / sight.centres, 1.0)
    for cause, (near, far, power), words in variants:
        wrong = _airlight(sight, ray, np.array(position), near, far, power)

        def predict(wrong: np.ndarray = wrong) -> np.ndarray:
            return np.asarray((direct + airlight * (wrong / right)) * to_means)

        yield fixed(cause, predict, words)


def _depth(sight: Sight) -> Iterator[ImageCause]:
    """Yield the depth along the axis for the distance along the ray: of what comes straight, and of where the wall is."""
    scene = sight.scene
    medium: Any = scene.medium
    x0, y0, _, _ = scene.camera.film.window
    ray: Ray = given(scene.camera, "fogproof.analytic.cameras", "rays")(
        scene.camera, sight.columns + (x0 + 0.5), sight.rows + (y0 + 0.5)
    )
    ahead = np.subtract(scene.camera.target, scene.camera.origin)
    cosine = (np.broadcast_to(ray.direction, (len(sight.rows), 3)) @ (ahead / np.linalg.norm(ahead)))[:, None]
    if np.ptp(cosine) < FLAT:
        return
    words = "the depth along the camera's axis stands for the distance along the ray"
    if scene.scattering in ("none", "ambient") and hasattr(medium, "mean_free_path") and np.all(medium.sigma_t > 0):
        ambient = np.asarray(scene.ambient) if scene.scattering == "ambient" else 0.0
        source = np.asarray(medium.albedo) * ambient + (1 - np.asarray(medium.albedo)) * np.asarray(medium.emission)
        contrast = np.asarray(scene.background) - source

        def flat() -> np.ndarray:
            through = np.clip((sight.reference - source) / np.where(contrast == 0, 1.0, contrast), 0.0, 1.0)
            return np.asarray(source + contrast * through**cosine)

        if np.all(contrast != 0):
            yield fixed("depth-for-distance", flat, words)
    elif np.isfinite(scene.camera.wall):
        yield fixed("depth-for-distance", lambda: sight.instead(scene, wall_at_distance=True), words)


def _airlight(sight: Sight, ray: Ray, light: np.ndarray, near: float, far: float, power: float) -> np.ndarray:
    """Return int exp(-sigma (near t + far r)) f_p r^-power dt, (k, channels), in units that drop out."""
    medium: Any = sight.scene.medium
    sigma = np.atleast_1d(np.asarray(medium.sigma_t))
    q = light - ray.origin
    foot = np.sum(q * ray.direction, axis=-1)
    h = np.linalg.norm(q - foot[:, None] * ray.direction, axis=-1)
    low, high = np.arctan2(-foot, h), np.arctan2(np.minimum(ray.length, 1e9) - foot, h)
    angle = low[:, None] + (high - low)[:, None] * ((np.arange(NODES) + 0.5) / NODES)
    s = h[:, None] * np.tan(angle)
    r = np.hypot(s, h[:, None])
    mu = -s / r
    mu = np.clip(mu, -1, 1)
    f = np.asarray(phase_values(medium.phase, mu, (1 - mu) / 2, (1 + mu) / 2)[0])
    steps = (high - low)[:, None] / NODES * r * r / np.maximum(h[:, None], 1e-300)
    weight = f * steps * r**-power
    t = foot[:, None] + s
    return np.stack([np.sum(weight * np.exp(-one * (near * t + far * r)), axis=1) for one in sigma], axis=-1)
