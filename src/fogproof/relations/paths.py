"""Relations of radiance along one ray, as path tracers estimate it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fogproof.relations.anywhere import same
from fogproof.relations.setting import Comparison, PathSetting, RadianceTerm
from fogproof.scene import Ray, VoxelGrid
from fogproof.scene.lights import DirectionalLight
from fogproof.scene.shapes import Slab


def integrators(setting: PathSetting) -> Iterator[Comparison]:
    """Compare ways to gather light: next-event estimation, meeting the light, both."""
    if setting.light is None or setting.light.delta:
        return
    for how in ("nee", "mis"):
        told = "next-event estimation: its pdf, its shadow rays, its weight against light that is met"
        first, second = (setting.but(light_sampling=one) for one in ("bsdf", how))
        yield same(f"integrators/{how}", told, first, second)


def majorants(setting: PathSetting) -> Iterator[Comparison]:
    """Compare tracking under the medium's own majorant with one three times as high."""
    medium = setting.medium
    if isinstance(medium, VoxelGrid) and medium.channels is None:
        raised = setting.but(majorant=3.0 * float(np.max(medium.sigma_t)))
        yield same(
            "majorant", "null collisions: a majorant that is exceeded, or weights that depend on it", setting, raised
        )


def sums_of_orders(setting: PathSetting) -> Iterator[Comparison]:
    """Compare all orders up to the second with the orders one by one."""
    if setting.only is not None or setting.medium.channels is not None:
        return
    alone = tuple(RadianceTerm(setting.but(only=order, deepest=2)) for order in range(3))
    told = "counting of orders: one too many, one too few, what crosses a boundary counted"
    yield Comparison("orders", told, (RadianceTerm(setting.but(deepest=2)),), alone)


def reciprocity(setting: PathSetting) -> Iterator[Comparison]:
    """Compare with camera and sun swapped, above a slab: radiance over the sun's cosine is symmetric."""
    if not (
        isinstance(setting.light, DirectionalLight) and isinstance(setting.shape, Slab) and setting.surface is None
    ):
        return
    normal = np.asarray(setting.shape.normal)
    view, sun = np.asarray(setting.ray.direction), np.asarray(setting.light.direction)
    mu, mu0 = float(view @ normal), float(sun @ normal)
    if mu * mu0 <= 0:
        return  # they are on different sides
    origin = np.asarray(setting.ray.origin)
    there = Ray(origin, sun, setting.ray.length)
    swapped = setting.but(ray=there, light=DirectionalLight(tuple(view), setting.light.irradiance))
    told = "phase functions and surfaces that are not symmetric, a cosine at the wrong end"
    yield Comparison("reciprocity", told, (RadianceTerm(setting, 1 / abs(mu0)),), (RadianceTerm(swapped, 1 / abs(mu)),))


ALONG_A_RAY = (integrators, majorants, sums_of_orders, reciprocity)
