"""Relations of images that have to do with the medium, what it fills, and how light is followed in it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.relations.anywhere import same
from fogproof.relations.setting import Comparison, ImageSetting, RadianceTerm
from fogproof.scene import HenyeyGreenstein, Isotropic, Medium, VoxelGrid
from fogproof.scene.cameras import Film, OneRay, Orthographic, Perspective
from fogproof.scene.lights import DirectionalLight, Environment
from fogproof.scene.shapes import EVERYWHERE, Ball, Box, HalfSpace, Slab

OPAQUE = 50.0
"""Mean free paths through which 1e-21 of the light gets."""

GRAZING = 0.05
"""Cosine below which sun or camera are too low to be swapped."""

BOUNDED = (Ball, Box, Slab)


def large_box(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare a medium that fills space with a box so large that no path leaves it."""
    scene, within = setting.scene, _reach(setting.scene)
    if scene.shape != EVERYWHERE or not isinstance(scene.medium, Medium) or within is None:
        return
    margin = np.ones(3)
    if scene.scattering == "multiple":
        thinnest = float(np.min(scene.medium.sigma_t))
        if not thinnest > 0:
            return
        margin = margin + OPAQUE / thinnest
    low, high = within[0] - margin, within[1] + margin
    told = "media that fill space: a camera inside without a boundary, or inside a boundary that it never sees"
    yield same("large-box", told, setting, setting.but(shape=Box(tuple(low), tuple(high))))


def _reach(scene: Any) -> tuple[np.ndarray, np.ndarray] | None:
    """Return corners of a box around all camera rays and the light, None where there is no end."""
    camera, light = scene.camera, scene.light
    if not np.isfinite(camera.wall) or (light is not None and not hasattr(light, "position")):
        return None
    origin, wide = np.asarray(camera.origin), 0.0
    if isinstance(camera, Perspective):
        wide = camera.half_width * np.hypot(1, camera.film.height / camera.film.width) * camera.wall
    elif isinstance(camera, Orthographic):
        wide = camera.width * np.hypot(1, camera.film.height / camera.film.width)
    around = np.hypot(camera.wall, wide)
    places = [origin - around, origin + around] + ([] if light is None else [np.asarray(light.position)])
    return np.min(places, axis=0), np.max(places, axis=0)


def deep_slab(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare a half space with a slab so thick that nothing gets through."""
    medium, shape = setting.medium, setting.shape
    if not (isinstance(shape, HalfSpace) and isinstance(medium, Medium) and np.min(medium.sigma_t) > 0):
        return
    if np.isfinite(setting.scene.camera.wall) or hasattr(setting.light, "position"):
        return
    depth = 2 * OPAQUE / float(np.min(medium.sigma_t))
    told = "half spaces: how far what is meant to be endless reaches"
    yield same("deep-slab", told, setting, setting.but(shape=Slab(shape.point, shape.normal, depth)))


def isotropic(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare isotropic scattering with Henyey-Greenstein's lobe of g = 0."""
    medium: Any = setting.medium
    if medium.phase == Isotropic() and np.any(medium.albedo) and setting.scene.scattering in ("single", "multiple"):
        other = setting.but(medium=replace(medium, phase=HenyeyGreenstein(0.0)))
        yield same("isotropic", "the phase function near g = 0: division by g, its constant", setting, other)


def finer_cells(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare a grid with the same grid cut into eight voxels for each, and with one that has a rim of empty voxels."""
    grid: Any = setting.medium
    if not isinstance(grid, VoxelGrid) or grid.interpolation != "nearest":
        return
    arrays = {name: np.asarray(getattr(grid, name)) for name in ("sigma_t", "albedo", "emission")}
    cells = {name: array for name, array in arrays.items() if array.ndim >= 3}
    finer: dict[str, Any] = {name: array.repeat(2, 0).repeat(2, 1).repeat(2, 2) for name, array in cells.items()}
    told = "walks through voxels: corners, faces, the size of the grid"
    yield same("finer-grid", told, setting, setting.but(medium=replace(grid, **finer)))
    rim: dict[str, Any] = {
        name: np.pad(array, [(1, 1)] * 3 + [(0, 0)] * (array.ndim - 3)) for name, array in cells.items()
    }
    size = (np.asarray(grid.upper) - np.asarray(grid.lower)) / grid.sigma_t.shape[:3]
    wider = replace(grid, lower=np.asarray(grid.lower) - size, upper=np.asarray(grid.upper) + size, **rim)
    told = "empty voxels: boundaries of the grid, the way to them, its transform"
    yield same("empty-rim", told, setting, setting.but(medium=wider))
    if setting.scene.scattering in ("none", "single") and len(cells) == 1:
        yield from _far_voxel(setting, wider)


def _far_voxel(setting: ImageSetting, wider: Any) -> Iterator[Comparison]:
    """Yield the comparison with a dense voxel in a corner of the empty rim that neither camera nor light looks at."""
    density = np.array(wider.sigma_t)
    size = (np.asarray(wider.upper) - np.asarray(wider.lower)) / density.shape[:3]
    for corner in np.ndindex(2, 2, 2):
        low = np.where(corner, np.asarray(wider.upper) - size, np.asarray(wider.lower))
        if _unseen(setting.scene, low, low + size, np.array(corner)):
            density[tuple(-1 if side else 0 for side in corner)] = 10 * np.max(density)
            told = "the majorant: null collisions where a voxel that no ray meets lifts it"
            yield same("far-voxel", told, setting, setting.but(medium=replace(wider, sigma_t=density)))
            return


def _unseen(scene: Any, low: np.ndarray, high: np.ndarray, corner: np.ndarray) -> bool:
    """Return whether no camera ray meets a box at the corner of a grid, and no light shines through it into the grid.

    The light does not if along some axis it stands on the grid's side of the box: all that is between it and the grid does then.
    """
    light = scene.light
    if scene.scattering == "single":
        sign = np.where(corner, 1.0, -1.0)
        nearest = np.where(corner, low, high)  # the box's inner face along each axis
        if hasattr(light, "position"):
            safe = np.any(sign * np.asarray(light.position) <= sign * nearest)
        elif hasattr(light, "direction"):
            safe = np.any(sign * np.asarray(light.direction) >= 0)
        else:
            return False
        if not safe:
            return False
    return not _in_view(scene.camera, 0.5 * (low + high), float(np.linalg.norm(high - low)))


def _in_view(camera: Any, center: np.ndarray, radius: float) -> bool:
    """Return whether a ball may be met by a ray of the camera: by the round cone or beam around its film."""
    to, ahead = center - np.asarray(camera.origin), np.subtract(camera.target, camera.origin)
    along = float(to @ ahead / np.linalg.norm(ahead))
    across = float(np.sqrt(max(to @ to - along * along, 0.0)))
    diagonal = np.hypot(1, camera.film.height / camera.film.width)
    if isinstance(camera, Perspective):
        half = np.arctan(camera.half_width * diagonal)
        distance = np.hypot(along, across)
        return bool(distance <= radius or np.arctan2(across, along) - np.arcsin(radius / distance) <= half)
    return bool(across <= radius + 0.5 * getattr(camera, "width", 0.0) * diagonal)


def absorbing(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare a medium that does not scatter under a sky that shines, followed to all orders, with what comes straight."""
    medium: Any = setting.medium
    if np.any(medium.emission):
        return
    black = replace(medium, **_albedo(medium, 0.0))
    lit = {"background": 1.0, "ambient": 0.0, "occluders": (), "medium": black}
    camera = replace(setting.scene.camera, wall=np.inf)
    first = setting.but(**lit, camera=camera, light=Environment(1.0), scattering="multiple")
    second = setting.but(**lit, camera=camera, light=None, scattering="none")
    told = "transmittance where nothing scatters: Beer-Lambert's law, albedo 0 as a special case"
    yield same("no-albedo", told, first, second)


def furnace(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare what scatters all light under a uniform sky with the sky."""
    medium: Any = setting.medium
    bounded = isinstance(setting.shape, BOUNDED) if isinstance(medium, Medium) else isinstance(medium, VoxelGrid)
    if not bounded or (isinstance(medium, VoxelGrid) and medium.channels is not None):
        return
    white = replace(medium, **_albedo(medium, 1.0), emission=0.0)
    camera = replace(setting.scene.camera, wall=np.inf)
    lit = setting.but(
        medium=white,
        camera=camera,
        light=Environment(1.0),
        background=1.0,
        ambient=0.0,
        occluders=(),
        scattering="multiple",
    )
    told = "conservation of energy: a phase function that is not normalised, orders that are cut off, roulette"
    yield Comparison("furnace", told, (RadianceTerm(lit),), (RadianceTerm(None),))


def _albedo(medium: Any, albedo: float) -> dict[str, Any]:
    """Return the fields that give a medium this albedo at the same extinction."""
    if isinstance(medium, Medium):
        sigma_t = medium.sigma_t
        parts = {"sigma_a": (1 - albedo) * sigma_t, "sigma_s": albedo * sigma_t}
        return {name: float(x) if np.ndim(x) == 0 else tuple(x.tolist()) for name, x in parts.items()}
    return {"albedo": albedo}


def orders(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare albedo a with twice a/2 less 0: light that has scattered at most once is linear in the albedo."""
    medium: Any = setting.medium
    albedo = np.asarray(medium.albedo)
    if setting.scene.scattering != "single" or np.any(medium.emission) or np.ndim(albedo) or not albedo > 0:
        return
    half, none = (setting.but(medium=replace(medium, **_albedo(medium, share * float(albedo)))) for share in (0.5, 0.0))
    told = "counting of orders: light that has scattered twice where once is asked for"
    yield Comparison("orders", told, (RadianceTerm(setting),), (RadianceTerm(half, 2.0), RadianceTerm(none, -1.0)))


def terms(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare light and background together with each alone."""
    scene = setting.scene
    if scene.scattering != "single" or not np.any(scene.background) or np.any(getattr(scene.medium, "emission", 0.0)):
        return
    light, straight = setting.but(background=0.0), setting.but(scattering="none")
    told = "the sum of what is scattered and what comes straight: weights between them"
    yield Comparison("terms", told, (RadianceTerm(setting),), (RadianceTerm(light), RadianceTerm(straight)))


def reciprocity(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare with camera and sun swapped, along one ray: radiance over the sun's cosine is symmetric for a slab."""
    scene, shape, light = setting.scene, setting.shape, setting.light
    if not (isinstance(light, DirectionalLight) and isinstance(shape, Slab) and isinstance(scene.medium, Medium)):
        return
    if scene.occluders or np.any(scene.background) or np.any(scene.medium.emission):
        return
    ahead, normal = np.subtract(scene.camera.target, scene.camera.origin), np.asarray(shape.normal)
    view, sun = ahead / np.linalg.norm(ahead), np.asarray(light.direction)
    cosines = abs(float(sun @ normal)), abs(float(view @ normal))
    if min(cosines) < GRAZING:
        return

    def seen(along: np.ndarray, lit: np.ndarray) -> ImageSetting:
        where = np.asarray(shape.point) - 2 * shape.thickness / GRAZING * along
        up = np.eye(3)[int(np.argmin(np.abs(along)))]
        camera = OneRay(tuple(where), tuple(where + along), Film(24, 24), tuple(up))
        return setting.but(camera=camera, light=DirectionalLight(tuple(lit), light.irradiance))

    told = "phase functions and boundaries that are not symmetric, a cosine at the wrong end"
    first, second = RadianceTerm(seen(view, sun), 1 / cosines[0]), RadianceTerm(seen(sun, view), 1 / cosines[1])
    yield Comparison("reciprocity", told, (first,), (second,))


OF_SCENES = (
    large_box,
    deep_slab,
    isotropic,
    finer_cells,
    absorbing,
    furnace,
    orders,
    terms,
    reciprocity,
)
