"""What the cases of single scattering share: media, lights, shapes, and how a case and its twin are made."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import (
    single_scattering,
    single_scattering_variance,
)
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.contracts import Draws
from fogproof.estimators import (
    Airlight,
    LitMedium,
    placer,
)
from fogproof.scene import (
    AnyMedium,
    HenyeyGreenstein,
    Medium,
    PhaseFunction,
    PointLight,
    Ray,
    VoxelGrid,
)
from fogproof.scene.lights import Light, SpotLight
from fogproof.scene.occluders import Disk, Sphere
from fogproof.scene.shapes import Ball, Box, HalfSpace, Slab

RAY = Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0), 5.0)


ENDLESS = Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0))


POINT = PointLight((0.6, -0.8, 0.5), 3.0)


CLOSE = PointLight((0.0, 0.01, 0.5), 3.0)


AXIS = (-6 / 11, 9 / 11, 2 / 11)


SPOT = SpotLight((0.6, -0.8, 0.5), AXIS, 3.0, 0.6, 0.3, 2)


BALL, BOX = Ball((0.2, 0.1, 0.0), 2.2), Box((-0.7, -0.9, -1.0), (0.7, 0.5, 1.0))


SLAB, GROUND = Slab((0.0, 0.0, -1.5), (0.0, 0.0, -1.0), 4.0), HalfSpace((0.0, 1.5, 0.0), (-0.6, 0.8, 0.0))


POST, PLATE = Sphere((0.35, -0.45, 0.4), 0.2), Disk((0.3, -0.4, 0.9), (0.6, -0.8, 0.0), 0.25)


def cloud(turned: bool = False, shift: float = 0.0) -> VoxelGrid:
    """Return a cloud of 6 x 6 x 6 voxels; for twins with its axes exchanged or moved by a part of a voxel."""
    i, j, k = np.meshgrid(*[np.arange(6)] * 3, indexing="ij")
    sigma_t = 0.5 + 0.3 * np.cos(1.3 * i) * np.cos(0.9 * j + 1) + 0.2 * np.sin(1.1 * k)
    lower, upper = np.array([-1.5, -1.5, -2.0]), np.array([1.5, 1.5, 2.5])
    offset = shift * (upper - lower) / 6
    grid = sigma_t.transpose(2, 1, 0) if turned else sigma_t
    return VoxelGrid(grid, lower + offset, upper + offset, "nearest", 0.8, HenyeyGreenstein(0.5))


Factor = Callable[[LitMedium, np.ndarray], Any]
"""What a twin multiplies the contribution of each place with."""


_SOURCES = {
    "equiangular": "Kulla & Fajardo 2012",
    "mixed": "Veach & Guibas 1995; Kulla & Fajardo 2012",
}


def fog(phase: PhaseFunction | None = None) -> Medium:
    """Return the medium of most cases."""
    return Medium(0.1, 0.4, phase) if phase else Medium(0.1, 0.4)


def airlight_case(
    name: str,
    title: str,
    medium: AnyMedium,
    light: Light,
    error: str,
    factor: Factor | None = None,
    *,
    twin: Callable[[], Any] | None = None,
    ray: Ray = RAY,
    exact_variance: bool = False,
    samples: int = 500_000,
    **more: Any,
) -> EstimatorCase:
    """Return the case of `Airlight`; the name begins with the placing. The twin is the subject times a factor, or another."""
    placing: Any = name.split("/")[0]

    def broken() -> Drawn:
        assert factor is not None
        return times(factor, LitMedium(medium, ray, light, **more), placing)

    def variance() -> Any:
        uniform: Any = medium
        assert isinstance(light, PointLight)
        return single_scattering_variance(uniform, ray, light, placing)

    geometry = {key: value for key, value in more.items() if key != "shadow_rays"}
    return EstimatorCase(
        name=f"airlight/{name}",
        title=f"Airlight, {title}",
        make=lambda: Airlight(medium, ray, light, placing, **more),
        reference=lambda: single_scattering(medium, ray, light, **geometry),
        variance=variance if exact_variance else None,
        cost=(lambda: 1.0) if exact_variance else None,
        oracle="single_scattering, single_scattering_variance" if exact_variance else "single_scattering",
        source=_SOURCES.get(placing, "volume rendering equation, one-sample estimator"),
        twin=Twin(error, twin or broken),
        samples=samples,
    )


def times(factor: Factor, lit: LitMedium, placing: Any) -> Drawn:
    """The one-sample estimator again, each contribution multiplied by an error."""
    places = placer(lit, placing)

    def draw(rng: np.random.Generator, n: int) -> Draws:
        drawn = places.sample(rng.random((n, 1)))
        inside = np.ones(n, bool) if drawn.event is None else drawn.event == 0
        t = np.where(inside, drawn.x, 0.0)
        value = lit.seen(t) * lit.scattered(t, rng)[0] / drawn.pdf * factor(lit, t)
        return Draws(np.where(inside, value, 0.0), cost=np.ones(n))

    return Drawn(draw)


def distance_to_light(lit: LitMedium, t: np.ndarray) -> np.ndarray:
    """Return the distance of each place to the light [m]."""
    assert isinstance(lit.light, PointLight | SpotLight)
    return np.linalg.norm(lit.points(t) - np.asarray(lit.light.position)[:, None], axis=0)


def sigma_t_of(lit: LitMedium) -> float:
    """Return the extinction of a homogeneous medium [1/m]."""
    uniform: Any = lit.medium
    return float(uniform.sigma_t)


def constant(value: float) -> Factor:
    """Return the twin's factor that is the same everywhere."""
    return lambda lit, t: value
