"""What a scene can be drawn and answered with: one record, which `plan`, `estimator_for` and the studies read.

It follows from what the modules of the medium and of the light give (`fogproof.estimators.media`, `fogproof.estimators.lights`),
so that nobody keeps a second list: a kind that gives a closed form is drawn by it, another is tracked under its majorant, and what
neither the estimators nor the oracle can follow is refused here, by name, before anything is drawn.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from fogproof.analytic.media.breakpoints import extent
from fogproof.scene import AnyMedium, Scene
from fogproof.scene.kinds import given
from fogproof.scene.lights import strength
from fogproof.scene.media import box, is_empty, sources_vary
from fogproof.scene.one_channel import one_channel

MEDIA, LIGHTS = "fogproof.estimators.media", "fogproof.estimators.lights"

CameraRays = Literal["closed", "cells", "ratio"]
"""How the transmittance along the camera ray is found: in closed form, cell by cell, or by ratio tracking."""


@dataclass(frozen=True)
class Capabilities:
    """How a scene is drawn.

    camera_rays  how the transmittance along the camera ray is found
    shadow_rays  how that to the light is: "exact" or "ratio"
    placing      how the scattering event is placed: "equiangular", "distance" or "uniform"
    sources      "lerp" where albedo and emission are the same everywhere, "collision" where a path looks them up
    uniform      whether the extinction is the same everywhere
    refused      why neither oracle nor estimator follows the scene; "" if they do
    """

    camera_rays: CameraRays
    shadow_rays: Literal["exact", "ratio"]
    placing: Literal["equiangular", "distance", "uniform"]
    sources: Literal["lerp", "collision"]
    uniform: bool
    refused: str


def capabilities(scene: Scene) -> Capabilities:
    """Return how the first channel of a scene is drawn; the others are drawn alike."""
    grey = scene if scene.channels is None else one_channel(scene, 0)
    medium = grey.medium
    focus = None if grey.light is None else given(grey.light, LIGHTS, "focus")
    found = Capabilities(
        camera_rays=_camera_rays(medium),
        shadow_rays="exact" if given(medium, MEDIA, "depth_towards") else "ratio",
        placing="equiangular" if focus else "distance" if given(medium, MEDIA, "along") else "uniform",
        sources="collision" if sources_vary(medium) else "lerp",
        uniform=is_uniform(medium),
        refused="",
    )
    return Capabilities(**{**vars(found), "refused": _refused(grey, found)})


def is_uniform(medium: AnyMedium) -> bool:
    """Return whether the extinction is the same everywhere: no tracker is needed, and the medium may fill a shape."""
    return given(medium, MEDIA, "uniform") is not None


def has_cells(medium: AnyMedium) -> bool:
    """Return whether regular tracking can walk through the medium."""
    return given(medium, MEDIA, "walk") is not None


def is_lit(scene: Scene) -> bool:
    """Return whether light can scatter once into the camera: something scatters, and light arrives that is not dark."""
    light = scene.light
    if scene.scattering != "single" or light is None or not np.any(strength(light)):
        return False
    return scatters(scene.medium) and not is_too_far(scene)


def is_too_far(scene: Scene) -> bool:
    """Return whether light from infinitely far would have to cross an endless uniform medium: none arrives."""
    return scene.light is not None and scene.light.distant and is_uniform(scene.medium)


def scatters(medium: AnyMedium) -> bool:
    """Return whether anything in the medium scatters."""
    return not is_empty(medium) and _anywhere(getattr(medium, "sigma_s", medium.albedo))


def absorbs(medium: AnyMedium) -> bool:
    """Return whether anything in the medium absorbs."""
    own = getattr(medium, "sigma_a", None)
    share = medium.albedo if callable(medium.albedo) else np.subtract(1.0, medium.albedo)
    return not is_empty(medium) and _anywhere(share if own is None else own)


def emits(medium: AnyMedium) -> bool:
    """Return whether anything in the medium glows: where nothing absorbs, sigma_a L_e is 0."""
    return absorbs(medium) and _anywhere(medium.emission)


def _anywhere(value: Any) -> bool:
    """Return whether a coefficient is anywhere above 0; a function is taken to be."""
    return callable(value) or bool(np.any(value))


def _camera_rays(medium: AnyMedium) -> CameraRays:
    if has_cells(medium):
        return "cells"
    return "closed" if given(medium, MEDIA, "along") or given(medium, MEDIA, "depth") else "ratio"


def _refused(scene: Scene, how: Capabilities) -> str:
    """Return why the scene is not followed."""
    medium, name = scene.medium, type(scene.medium).__name__
    lit, endless = is_lit(scene), bool(np.isinf(scene.ray.length).any())
    bounded = bool(np.isfinite(box(medium)).all())
    looks_up = how.sources == "collision" and (emits(medium) or (scene.scattering == "ambient" and scatters(medium)))
    tracked = not is_empty(medium) and (how.camera_rays == "ratio" or looks_up or (lit and how.shadow_rays == "ratio"))
    if lit:
        assert scene.light is not None
        kind = type(scene.light).__name__
        if not (given(scene.light, LIGHTS, "illumination") or given(scene.light, LIGHTS, "sample")):
            return f"the light of a {kind} arrives from everywhere, which is followed in a homogeneous Medium in a shape only"
        if how.shadow_rays == "ratio" and scene.light.distant and not bounded:
            return f"the way of a {kind}'s light through a {name} without end: give the medium bounds"
        if not any(given(medium, MEDIA, part) for part in ("along", "depth", "feature_size")):
            return (
                f"how fine a {name} is (feature_size) is not known, so its depth along the camera ray is not integrated"
            )
        ends = bounded or bool(np.isfinite(extent(medium, scene.ray).leave).all())
        if endless and not how.uniform and not (bounded if how.placing == "uniform" else ends):
            return f"light along an endless ray through a {name} without end: give the ray a length"
    if tracked and not given(medium, MEDIA, "bounds"):
        return f"no bound of the extinction of a {name} is known, so it cannot be tracked"
    if tracked and endless and not bounded:
        return f"an endless ray through a {name} without end: give the ray a length"
    return ""
