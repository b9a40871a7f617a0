"""One order of scattering too many or too few: what a second collision adds, by a small Monte Carlo of its own.

    L_2 = int T sigma_s int f_p(w . d) L_1(x_t, w) dw dt

The first collision and its direction are drawn, L_1 is the oracle's. The ratio of L_2 to the image is smooth: a polynomial over the
film is fitted to it, which takes most of the noise away.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.analytic import phase_pdf, single_scattering
from fogproof.analytic.geometry.convex_shapes import chord
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.errors import UnsupportedError
from fogproof.images.causes.image_cause import ImageCause, Sight, fixed
from fogproof.scene import Ray
from fogproof.scene.kinds import given

PATHS = 1 << 16
DEGREE = 4

COARSE = 0.2
"""Share of the second order by which its own Monte Carlo may be off on average, to be held against an image."""


def hypotheses(sight: Sight) -> Iterator[ImageCause]:
    """Yield the image with one order of scattering too many, or with the first or the first two alone."""
    scene = sight.scene
    medium: Any = scene.medium
    if scene.scattering not in ("single", "multiple") or not np.any(medium.albedo):
        return
    if scene.scattering == "multiple":
        once = replace(scene, scattering="single")
        words = "one-order-too-few", "only light that scattered once is there, higher orders are missing"
        yield fixed(words[0], lambda: sight.instead(once), words[1])
    else:
        whole = replace(scene, scattering="multiple")
        yield fixed(
            "all-orders", lambda: sight.instead(whole), "all orders of scattering are there, not the first alone"
        )
    if not hasattr(medium, "mean_free_path"):
        return
    try:
        found = _second_order(sight)
    except UnsupportedError:
        return
    if found is None:
        return
    ratio, blur = found
    blur = np.abs(sight.reference) * blur
    if scene.scattering == "multiple":
        told = "only light that scattered once or twice is there, higher orders are missing"
        yield fixed(
            "one-order-too-few", lambda: sight.instead(once) + np.asarray(sight.reference * ratio), told, blur=blur
        )
        return

    def more(share: float) -> np.ndarray:
        return np.asarray(sight.reference * (1 + share * ratio))

    def words_of(p: np.ndarray) -> str:
        return f"{p[0]:.2g} times the light that scatters twice is there"

    times = float(np.mean(more(1.0)) / np.mean(sight.reference))
    told = f"one scattering order too many, ratio {times:.3g}: light that scattered twice is there"
    yield fixed("one-order-too-many", lambda: more(1.0), told, blur=blur)
    start = ((1.0,),)
    yield ImageCause("one-order-too-many", lambda p: more(float(p[0])), words_of, start, 0.0, 20.0, blur=blur)


def _second_order(sight: Sight) -> tuple[np.ndarray, np.ndarray] | None:
    """Return L_2 / reference at the chosen pixels (k, channels), smoothed, and its error; None where that is not known."""
    scene, rng = sight.scene, np.random.default_rng(1)
    medium: Any = scene.medium
    light: Any = scene.light
    which = np.tile(np.arange(len(sight.rows)), max(1, PATHS // len(sight.rows)))
    x0, y0, _, _ = scene.camera.film.window
    rays = given(scene.camera, "fogproof.analytic.cameras", "rays")
    ray: Ray = rays(scene.camera, sight.columns[which] + (x0 + 0.5), sight.rows[which] + (y0 + 0.5))
    inside = chord(scene.shape, FlatRays(ray.origin, ray.direction, ray.length))
    thinnest = float(np.min(np.atleast_1d(medium.sigma_t)))
    span = np.minimum(inside.end - inside.start, 30 / max(thinnest, 1e-300))
    into = span * rng.random(len(which))
    x = ray.origin + (inside.start + into)[:, None] * ray.direction
    w = rng.normal(size=x.shape)
    w /= np.linalg.norm(w, axis=1)[:, None]
    length = np.full(len(x), np.inf)
    if np.isfinite(scene.camera.wall):
        ahead = np.subtract(scene.camera.target, scene.camera.origin)
        ahead = ahead / np.linalg.norm(ahead)
        with np.errstate(all="ignore"):
            way = (scene.camera.wall - (x - np.array(scene.camera.origin)) @ ahead) / (w @ ahead)
        length = np.where(way > 0, way, np.inf)
    once: np.ndarray = single_scattering(
        medium, Ray(x, w, length), light, shape=scene.shape, occluders=scene.occluders
    ).value
    once = once.reshape(len(x), -1)
    turn = np.clip(np.sum(w * ray.direction, axis=1), -1, 1)
    scattered = np.exp(-into[:, None] * np.atleast_1d(medium.sigma_t)) * np.atleast_1d(medium.sigma_s)
    turned: np.ndarray = phase_pdf(medium.phase, turn).value
    twice = scattered * turned.reshape(-1, 1) * once * np.reshape(4 * np.pi * span, (-1, 1))
    twice = np.where(np.isfinite(twice), twice, 0.0)
    mean = np.zeros(sight.reference.shape)
    np.add.at(mean, which, np.broadcast_to(twice, (len(which), sight.reference.shape[1])))
    mean /= len(which) / len(sight.rows)
    if not mean.any():
        return None
    ratio, error = _smooth(sight, mean / np.maximum(sight.reference, 1e-6 * float(np.max(sight.reference))))
    return (ratio, error) if float(np.mean(error)) <= COARSE * float(np.mean(ratio)) else None


def _smooth(sight: Sight, ratio: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a polynomial over the film fitted to values at the chosen pixels, and its standard error there."""
    rows, columns = sight.found.reference.shape[:2]
    u, v = 2 * sight.columns / columns - 1, 2 * sight.rows / rows - 1
    terms = [u**i * v**j for i in range(DEGREE + 1) for j in range(DEGREE + 1 - i)]
    basis = np.stack(terms, axis=1)
    fitted = basis @ np.linalg.lstsq(basis, ratio, rcond=None)[0]
    spread = np.sum((ratio - fitted) ** 2, axis=0) / max(len(ratio) - basis.shape[1], 1)
    lever = np.sum(basis @ np.linalg.pinv(basis.T @ basis) * basis, axis=1)
    return np.maximum(fitted, 0.0), np.sqrt(np.maximum(lever, 0.0)[:, None] * spread)
