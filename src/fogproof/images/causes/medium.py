"""The medium: another phase function, another g, another density or albedo, a clipped beginning."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from fogproof.images.causes.image_cause import ImageCause, Sight, fixed
from fogproof.scene import CornetteShanks, HenyeyGreenstein, Isotropic, Rayleigh, Schlick

SCAN = ((-0.9,), (-0.7,), (-0.5,), (-0.3,), (-0.1,), (0.1,), (0.3,), (0.5,), (0.7,), (0.9,))


def hypotheses(sight: Sight) -> Iterator[ImageCause]:
    """Yield scenes with another medium."""
    scene = sight.scene
    medium: Any = scene.medium
    if not hasattr(medium, "sigma_s"):
        yield from _near(sight)
        return
    if scene.scattering in ("single", "multiple") and np.any(medium.sigma_s):
        yield from _phases(sight)
    if np.any(medium.sigma_a) and np.any(medium.sigma_s):
        swapped = replace(medium, sigma_a=medium.sigma_s, sigma_s=medium.sigma_a)
        yield _with(sight, "coefficients-exchanged", swapped, "sigma_a and sigma_s are exchanged")
        yield _with(sight, "no-absorption", replace(medium, sigma_a=0.0), "sigma_t is sigma_s: absorption is missing")

    def denser(p: np.ndarray) -> np.ndarray:
        other = replace(medium, sigma_a=_times(medium.sigma_a, p[0]), sigma_s=_times(medium.sigma_s, p[0]))
        return sight.instead(replace(scene, medium=other))

    def words(p: np.ndarray) -> str:
        return f"the medium is {p[0]:.5g} times as dense"

    yield ImageCause("density", denser, words, ((0.5,), (0.9,), (1.1,), (2.0,)), 1e-3, 1e3)
    yield from _near(sight)


def _near(sight: Sight) -> Iterator[ImageCause]:
    reach = sight.scene.camera.wall
    scale = reach if np.isfinite(reach) else 10.0
    yield ImageCause(
        "near-clip",
        lambda p: sight.instead(sight.scene, near=float(p[0])),
        lambda p: f"rays start {p[0]:.4g} m too late: a near clip",
        ((1e-3 * scale,), (0.01 * scale,), (0.1 * scale,)),
        0,
        scale,
    )


def _phases(sight: Sight) -> Iterator[ImageCause]:
    medium: Any = sight.scene.medium
    phase = medium.phase
    g = float(getattr(phase, "g", 0.0))

    def seen_by(other: Any) -> np.ndarray:
        return sight.instead(replace(sight.scene, medium=replace(medium, phase=other)))

    if g:
        yield fixed(
            "wrong-sign-of-g", partial(seen_by, replace(phase, g=-g)), f"g has the wrong sign: {-g:g} for {g:g}"
        )
        yield fixed("isotropic", partial(seen_by, Isotropic()), f"scattering is isotropic, g = {g:g} has no effect")
        k = 1.55 * g - 0.55 * g**3
        for sign in (1, -1):
            words = f"Schlick's approximation with k = {'-' if sign < 0 else ''}(1.55 g - 0.55 g^3) = {sign * k:.4g}"
            words += f" stands for Henyey-Greenstein with g = {g:g}"
            yield fixed("schlick-for-henyey-greenstein", partial(seen_by, Schlick(sign * k)), words)
        for other in (CornetteShanks(g), HenyeyGreenstein(g)):
            if other != phase:
                yield fixed("wrong-phase-function", partial(seen_by, other), f"{type(other).__name__} with g = {g:g}")
    if phase != Rayleigh():
        yield fixed("wrong-phase-function", partial(seen_by, Rayleigh()), "Rayleigh's phase function")

    def fitted(p: np.ndarray) -> str:
        own = f"{g:g}" if g else type(phase).__name__
        return f"{'g' if g else 'Henyey-Greenstein with g'} = {p[0]:.4g} stands for {own}"

    special = (
        (0.0, "isotropic", f"scattering is isotropic, g = {g:g} has no effect"),
        (-g, "wrong-sign-of-g", f"g has the wrong sign: {-g:g} for {g:g}"),
    )
    yield ImageCause(
        "wrong-g",
        lambda p: seen_by(HenyeyGreenstein(float(p[0]))),
        fitted,
        (*SCAN, (g,)),
        -0.99,
        0.99,
        special=special if g else (),
    )
    yield ImageCause(
        "schlick-for-henyey-greenstein",
        lambda p: seen_by(Schlick(float(p[0]))),
        lambda p: f"Schlick's approximation with k = {p[0]:.4g} stands for {type(phase).__name__}",
        SCAN,
        -0.99,
        0.99,
    )


def _with(sight: Sight, cause: str, medium: Any, words: str) -> ImageCause:
    other = replace(sight.scene, medium=medium)
    return fixed(cause, partial(sight.instead, other), words)


def _times(value: Any, factor: float) -> Any:
    return tuple(x * factor for x in value) if isinstance(value, tuple) else value * factor
