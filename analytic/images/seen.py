"""What camera rays see of an image's scene: the medium that fills a shape, and the background behind it."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.airlight.single_scattering import single_scattering
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.geometry.convex_shapes import chord
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.analytic.images.scattered_to_the_end import scattered_to_the_end
from fogproof.analytic.media.coefficients import is_uniform
from fogproof.analytic.rays.ambient_fog import ambient_fog
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import ImageScene, Ray
from fogproof.scene.shapes import EVERYWHERE

Seen = tuple[np.ndarray, np.ndarray]
"""Radiance and its error, (n, channels) each."""


def seen(scene: ImageScene, ray: Ray) -> Seen:
    """Return the radiance along rays of shape (n,) [W/(m^2 sr)], grey as one channel.

    Background and emission along the part of the ray in the shape, and in-scattering as far as the scene follows it.
    """
    if scene.scattering == "multiple" and np.any(scene.medium.albedo):
        value, error = scattered_to_the_end(scene, ray)
        return _columns(value, scene), _columns(error, scene)
    value, error = _direct(scene, ray)
    if scene.scattering == "single" and not scene.dark:
        assert scene.light is not None
        shape = scene.shape if is_uniform(scene.medium) else EVERYWHERE
        lit = single_scattering(scene.medium, ray, scene.light, occluders=scene.occluders, shape=shape)
        value = value + _columns(lit.value, scene)
        error = error + _columns(lit.error, scene) + EPS * value
    return value, error


def _direct(scene: ImageScene, ray: Ray) -> Seen:
    """Return what is seen of background, emission and ambient light."""
    ambient = scene.ambient if scene.scattering == "ambient" else 0.0
    if scene.shape == EVERYWHERE:
        found: Reference = ambient_fog(scene.medium, ray, ambient, scene.background)
        return _columns(found.value, scene), _columns(found.error, scene)
    if not is_uniform(scene.medium):
        raise UnsupportedError(f"a {type(scene.medium).__name__} has bounds of its own: leave the shape away", "shape")
    inside = chord(scene.shape, FlatRays(ray.origin, ray.direction, ray.length))
    low, high = inside.sure_end - inside.sure_start, inside.end - inside.start
    length = np.where(np.isinf(high), np.inf, 0.5 * (low + high))
    found = ambient_fog(
        scene.medium, Ray(ray.origin, ray.direction, np.maximum(length, 0.0)), ambient, scene.background
    )
    with np.errstate(invalid="ignore"):
        unsure = np.where(np.isinf(high), 0.0, 0.5 * (high - low))
    brightest = np.max([np.max(x) for x in (scene.background, ambient, scene.medium.emission)])
    blur = -np.expm1(-unsure * np.max(scene.medium.sigma_t)) * brightest
    return _columns(found.value, scene), _columns(found.error, scene) + blur[:, None]


def _columns(x: np.ndarray, scene: ImageScene) -> np.ndarray:
    """Return an array (n,) or (n, channels) with as many columns as the scene has channels."""
    columns = x[:, None] if x.ndim == 1 else x
    return np.broadcast_to(columns, (len(columns), scene.channels or 1))
