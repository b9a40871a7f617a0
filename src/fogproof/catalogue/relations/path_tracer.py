"""Every relation of our own path tracer, and a fault of a renderer that only relations show."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.catalogue.twins import renderers
from fogproof.catalogue.twins.renderers import Renderer, traced
from fogproof.relations import Comparison, PathSetting, comparisons
from fogproof.relations.drawn import drawn
from fogproof.scene import HenyeyGreenstein, Medium, Ray, VoxelGrid
from fogproof.scene.lights import DirectionalLight, Environment
from fogproof.scene.shapes import Box, Slab

SOURCE = "metamorphic testing: Chen, Cheung & Yiu 1998"

LOBE = HenyeyGreenstein(0.6)
BOX = Box((0.0, 0.0, 0.0), (1.0, 1.5, 2.0))
ACROSS = Ray((0.4, 0.6, -1.0), np.array([0.1, 0.15, 1.0]) / np.linalg.norm([0.1, 0.15, 1.0]), np.inf)
SKY = Environment(1.0)

IN_A_BOX = PathSetting(Medium(0.4, 1.6, LOBE), BOX, ACROSS, SKY)
IN_COLOUR = PathSetting(Medium((0.2, 0.5, 1.0), (2.0, 1.0, 3.0), LOBE), BOX, ACROSS, SKY)
IN_A_GRID = PathSetting(
    VoxelGrid(
        np.random.default_rng(7).uniform(0.2, 4.0, (2, 3, 4)), BOX.lower, BOX.upper, "nearest", albedo=0.8, phase=LOBE
    ),
    BOX,
    ACROSS,
    SKY,
)
IN_A_SLAB = PathSetting(
    Medium(0.1, 0.9, LOBE),
    Slab((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 1.0),
    Ray((0.0, 0.0, 3.0), (np.sqrt(0.75), 0.0, -0.5), np.inf),
    DirectionalLight((0.6, 0.0, -0.8), 1.0),
)
"""Settings that between them allow every relation."""


def _difference(comparison: Comparison, render: Renderer) -> Drawn:
    """Return an estimator of 0: one side less the other."""
    first, second = drawn(render, comparison.first), drawn(render, comparison.second)

    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        return first(rng, n) - second(rng, n)

    return Drawn(draw)


def _case(setting: PathSetting, name: str, fault: Callable[[PathSetting], Any]) -> EstimatorCase:
    (comparison,) = (found for found in comparisons(setting) if found.name == name)
    return EstimatorCase(
        name=f"relations/{name}",
        title=f"The same radiance on both sides of the relation {name}",
        make=partial(_difference, comparison, traced),
        reference=0.0,
        oracle="none: both sides are drawn",
        twin=Twin(str(fault.__doc__).rstrip("."), partial(_difference, comparison, fault)),
        source=SOURCE,
        samples=1_000_000 if setting is IN_A_SLAB else 200_000,  # skewed by the lobe
    )


def cases() -> list[EstimatorCase]:
    """Return a case for each relation."""
    return [
        _case(IN_A_BOX, "constant-grid/nearest", _grid_is_denser),
        _case(IN_A_BOX, "constant-grid/trilinear", renderers.border_of_half_a_voxel),
        _case(IN_A_SLAB, "cut-slab", renderers.boundaries_are_bounces),
        _case(IN_A_BOX, "equal-channels", renderers.sum_of_channels),
        _case(IN_COLOUR, "channel-alone/0", renderers.pdf_of_the_first_channel),
        _case(IN_COLOUR, "channel-alone/2", renderers.majorant_of_the_first_channel),
        _case(IN_A_BOX, "integrators/nee", renderers.attenuated_beyond_the_medium),
        _case(IN_A_BOX, "integrators/mis", renderers.light_counted_twice),
        _case(IN_A_GRID, "majorant", renderers.majorant_exceeded),
        _case(IN_A_GRID, "moved/1", renderers.density_ignores_the_transform),
        _case(IN_A_BOX, "moved/500", renderers.offset_by_coordinates),
        _case(IN_A_BOX, "turned", renderers.flipped_near_the_horizon),
        _case(IN_A_BOX, "scaled/0.001", renderers.offset_in_metres),
        _case(IN_A_SLAB, "linear-in-light", renderers.clamped),
        _case(IN_A_SLAB, "orders", renderers.one_order_too_many),
        _case(IN_A_SLAB, "reciprocity", renderers.a_cosine_too_many),
    ]


def _grid_is_denser(setting: PathSetting) -> Any:
    """The grid's density is multiplied by its scale twice."""
    import dataclasses

    medium = setting.medium
    if isinstance(medium, VoxelGrid):
        medium = dataclasses.replace(medium, sigma_t=1.2 * medium.sigma_t)
    return traced(setting.but(medium=medium))
