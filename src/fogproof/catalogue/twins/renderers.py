"""Renderers for relations: our own path tracer, and what it would be with faults that users of renderers have reported.

A fault is a function from the setting a renderer is asked for to the one it really renders, or something done to its values.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.catalogue.cases import Drawn
from fogproof.catalogue.twins.paths import LiteralPaths
from fogproof.contracts import Draws, Estimator
from fogproof.estimators import PathTracer, SpectralPathTracer
from fogproof.relations import PathSetting
from fogproof.scene import HenyeyGreenstein, Medium, PiecewiseConstantMedium, VoxelGrid
from fogproof.scene.shapes import Box, Slab

Renderer = Callable[[PathSetting], Estimator]


def traced(setting: PathSetting) -> Estimator:
    """Return our path tracer for a setting."""
    common: dict[str, Any] = {
        name: getattr(setting, name)
        for name in ("medium", "shape", "ray", "light", "surface", "light_sampling", "majorant", "deepest")
    }
    if setting.medium.channels is not None:
        return SpectralPathTracer(**common)
    if setting.only is None:
        return PathTracer(**common)
    tracer, order = PathTracer(**common, columns=setting.only + 2), setting.only
    return _valued(tracer, lambda value: value[:, order])


def _valued(estimator: Any, alter: Callable[[np.ndarray], np.ndarray]) -> Drawn:
    def draw(rng: np.random.Generator, n: int) -> Draws:
        return Draws(alter(np.asarray(estimator.draw(rng, n).value)))

    return Drawn(draw)


def density_ignores_the_transform(setting: PathSetting) -> Estimator:
    """The grid is moved, but its density is looked up with coordinates of the world, clamped to its border."""
    medium = setting.medium
    if isinstance(medium, VoxelGrid):
        size = (np.asarray(medium.upper) - np.asarray(medium.lower)) / medium.sigma_t.shape[:3]
        moved = np.rint(np.asarray(medium.lower) / size).astype(int)
        places = [np.clip(np.arange(n) + k, 0, n - 1) for n, k in zip(medium.sigma_t.shape, moved, strict=False)]
        medium = dataclasses.replace(medium, sigma_t=medium.sigma_t[np.ix_(*places)])
    return traced(setting.but(medium=medium))


def offset_by_coordinates(setting: PathSetting) -> Estimator:
    """Rays start inside by a share of how large their coordinates are."""
    return traced(_entered_late(setting, 1e-3 * float(np.max(np.abs(setting.ray.origin)))))


def offset_in_metres(setting: PathSetting) -> Estimator:
    """Rays start inside by a tenth of a millimetre, however small the scene is."""
    return traced(_entered_late(setting, 1e-4))


def _entered_late(setting: PathSetting, offset: float) -> PathSetting:
    shape: Any = setting.shape
    if isinstance(shape, Box):
        inset = np.minimum(offset, 0.3 * (np.asarray(shape.upper) - np.asarray(shape.lower)))
        shape = Box(tuple(np.asarray(shape.lower) + inset), tuple(np.asarray(shape.upper) - inset))
    elif isinstance(shape, Slab):
        shape = dataclasses.replace(shape, thickness=max(shape.thickness - offset, 0.3 * shape.thickness))
    return setting.but(shape=shape)


def pdf_of_the_first_channel(setting: PathSetting) -> Estimator:
    """Paths are weighed by the pdf of the first channel, whichever has decided."""
    if setting.medium.channels is None:
        return traced(setting)
    return _literal(setting, first_channel=True)


def light_counted_twice(setting: PathSetting) -> Estimator:
    """Light is looked for and met, and both count in full."""
    if setting.light_sampling != "mis":
        return traced(setting)
    return _literal(setting, looked_for=True, share_light=False)


def attenuated_beyond_the_medium(setting: PathSetting) -> Estimator:
    """Shadow rays are attenuated far beyond the medium, so that hardly anything arrives."""
    if setting.light_sampling != "nee":
        return traced(setting)
    return _valued(traced(setting), lambda value: 1e-3 * value)


def _literal(setting: PathSetting, **faults: Any) -> Estimator:
    medium, light = setting.medium, setting.light
    assert isinstance(medium, Medium)
    return LiteralPaths(medium, setting.shape, setting.ray, light, **faults)  # type: ignore[arg-type]


def majorant_of_the_first_channel(setting: PathSetting) -> Estimator:
    """What exceeds the majorant of the first channel counts as if it reached it."""
    medium = setting.medium
    if isinstance(medium, Medium) and medium.channels is not None:
        sigma_t = medium.sigma_t
        share = np.minimum(sigma_t, sigma_t[0]) / sigma_t
        medium = Medium(tuple(medium.sigma_a * share), tuple(medium.sigma_s * share), medium.phase, medium.emission)
    return traced(setting.but(medium=medium))


def majorant_exceeded(setting: PathSetting) -> Estimator:
    """The renderer's own majorant is the mean of the grid: voxels above it count as if they reached it."""
    medium = setting.medium
    if isinstance(medium, VoxelGrid) and setting.majorant is None:
        medium = dataclasses.replace(medium, sigma_t=np.minimum(medium.sigma_t, np.mean(medium.sigma_t)))
    return traced(setting.but(medium=medium))


def boundaries_are_bounces(setting: PathSetting) -> Estimator:
    """Boundaries between equal media count as scatterings, of which four are allowed."""
    allowed = 1 if isinstance(setting.medium, PiecewiseConstantMedium) else 4
    return traced(setting.but(deepest=allowed if setting.deepest is None else min(allowed, setting.deepest)))


def sum_of_channels(setting: PathSetting) -> Estimator:
    """Paths in colour are divided by the sum of the channels' pdfs, not by their mean."""
    estimator, channels = traced(setting), setting.medium.channels
    return estimator if channels is None else _valued(estimator, lambda value: value / channels)


def clamped(setting: PathSetting) -> Estimator:
    """Values above 2 are cut to 2."""
    return _valued(traced(setting), lambda value: np.minimum(value, 2.0))


def one_order_too_many(setting: PathSetting) -> Estimator:
    """Paths end one scattering too late."""
    if setting.deepest is None or setting.only is not None:
        return traced(setting)
    return traced(setting.but(deepest=setting.deepest + 1))


def a_cosine_too_many(setting: PathSetting) -> Estimator:
    """What leaves the surface is weighed by its cosine."""
    if not isinstance(setting.shape, Slab):
        return traced(setting)
    cosine = abs(float(np.asarray(setting.ray.direction) @ np.asarray(setting.shape.normal)))
    return _valued(traced(setting), lambda value: value * cosine)


def border_of_half_a_voxel(setting: PathSetting) -> Estimator:
    """A trilinear grid ends where its outermost values stand."""
    medium = setting.medium
    if isinstance(medium, VoxelGrid) and medium.interpolation == "trilinear":
        half = 0.5 * (np.asarray(medium.upper) - np.asarray(medium.lower)) / medium.sigma_t.shape[:3]
        inner = Box(tuple(np.asarray(medium.lower) + half), tuple(np.asarray(medium.upper) - half))
        return traced(setting.but(shape=inner))
    return traced(setting)


def flipped_near_the_horizon(setting: PathSetting) -> Estimator:
    """The frame of a direction is turned round where its third coordinate is small."""
    medium: Any = setting.medium
    if abs(float(setting.ray.direction[2])) < 0.5:
        medium = dataclasses.replace(medium, phase=HenyeyGreenstein(-medium.phase.g))
    return traced(setting.but(medium=medium))
