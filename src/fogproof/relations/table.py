"""The relations: what each changes, and what must come of it. None asks for more than its setting gives."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from fogproof.relations.moved import scaled, translated, turned
from fogproof.relations.setting import Comparison, PathSetting, RadianceTerm
from fogproof.scene import Medium, PiecewiseConstantMedium, Ray, VoxelGrid
from fogproof.scene.lights import DirectionalLight, strength, with_strength
from fogproof.scene.shapes import Box, Slab

Relation = Callable[[PathSetting], Iterator[Comparison]]

FAR = (1.0, 30.0, 500.0)
"""How far everything is moved [m]: offsets in absolute units show at one of them."""

SCALES = (100.0, 1e-3)


def _same(name: str, isolates: str, first: PathSetting, second: PathSetting, factor: float = 1.0) -> Comparison:
    return Comparison(name, isolates, (RadianceTerm(first),), (RadianceTerm(second, factor),))


def constant_grids(setting: PathSetting) -> Iterator[Comparison]:
    """Compare a homogeneous box with grids of equal voxels."""
    medium, shape = setting.medium, setting.shape
    if not (isinstance(medium, Medium) and isinstance(shape, Box) and medium.channels is None):
        return
    for interpolation in ("nearest", "trilinear"):
        grid = VoxelGrid(
            np.full((2, 3, 2), float(medium.sigma_t)),
            shape.lower,
            shape.upper,
            interpolation,
            albedo=float(medium.albedo),
            phase=medium.phase,
            emission=float(np.asarray(medium.emission)),
        )
        told = f"look-ups of the {interpolation} grid, its transform, its majorant"
        yield _same(f"constant-grid/{interpolation}", told, setting, setting.but(medium=grid))


def equal_layers(setting: PathSetting) -> Iterator[Comparison]:
    """Compare a slab with the same slab cut into layers that touch."""
    medium, shape = setting.medium, setting.shape
    if not (isinstance(medium, Medium) and isinstance(shape, Slab) and medium.channels is None):
        return
    normal = np.asarray(shape.normal)
    bottom = float(normal @ np.asarray(shape.point))
    cuts = bottom + shape.thickness * np.array([-2.0, 0.25, 0.5, 2.0])
    layers = PiecewiseConstantMedium(
        cuts,
        np.full(3, float(medium.sigma_t)),
        normal,
        float(medium.albedo),
        medium.phase,
        float(np.asarray(medium.emission)),
    )
    told = "boundaries between equal media: paths that stop, bounce or are counted there"
    yield _same("cut-slab", told, setting, setting.but(medium=layers))


def equal_channels(setting: PathSetting) -> Iterator[Comparison]:
    """Compare a grey medium with three equal channels of it."""
    medium = setting.medium
    if not (isinstance(medium, Medium) and medium.channels is None and setting.surface is None):
        return
    if setting.only is not None:
        return
    three = Medium(
        (float(np.asarray(medium.sigma_a)),) * 3,
        (float(np.asarray(medium.sigma_s)),) * 3,
        medium.phase,
        medium.emission,
    )
    coloured = setting.but(medium=three)
    yield Comparison(
        "equal-channels",
        "the colours of a path: pdfs and weights of channels",
        (RadianceTerm(setting),),
        (RadianceTerm(coloured, 1.0, 1),),
    )


def channels_alone(setting: PathSetting) -> Iterator[Comparison]:
    """Compare each channel of a coloured medium with the grey medium it sees."""
    medium = setting.medium
    if not isinstance(medium, Medium) or medium.channels is None:
        return
    sigma_a, sigma_s, emission, *_ = np.broadcast_arrays(medium.sigma_a, medium.sigma_s, medium.emission)
    for c in range(medium.channels):
        grey = Medium(float(sigma_a[c]), float(sigma_s[c]), medium.phase, float(emission[c]))
        alone = setting.but(medium=grey, majorant=None)
        if setting.light is not None and np.ndim(strength(setting.light)):
            alone = alone.but(light=with_strength(setting.light, float(np.asarray(strength(setting.light))[c])))
        told = "the colours of a path: the pdf of one channel used for all, a majorant of one channel"
        yield Comparison(f"channel-alone/{c}", told, (RadianceTerm(setting, 1.0, c),), (RadianceTerm(alone),))


def integrators(setting: PathSetting) -> Iterator[Comparison]:
    """Compare ways to gather light: next-event estimation, meeting the light, both."""
    if setting.light is None or setting.light.delta:
        return
    for how in ("nee", "mis"):
        told = "next-event estimation: its pdf, its shadow rays, its weight against light that is met"
        first, second = (setting.but(light_sampling=one) for one in ("bsdf", how))
        yield _same(f"integrators/{how}", told, first, second)


def majorants(setting: PathSetting) -> Iterator[Comparison]:
    """Compare tracking under the medium's own majorant with one three times as high."""
    medium = setting.medium
    if isinstance(medium, VoxelGrid) and medium.channels is None:
        raised = setting.but(majorant=3.0 * float(np.max(medium.sigma_t)))
        yield _same(
            "majorant", "null collisions: a majorant that is exceeded, or weights that depend on it", setting, raised
        )


def moved(setting: PathSetting) -> Iterator[Comparison]:
    """Compare a setting with itself elsewhere."""
    for far in FAR:
        told = "transforms that one part ignores, offsets of rays that depend on the coordinates"
        yield _same(f"moved/{far:g}", told, setting, translated(setting, (far, -far, 0.5 * far)))


def rotated(setting: PathSetting) -> Iterator[Comparison]:
    """Compare a setting with itself turned."""
    yield _same("turned", "frames of directions, transforms of grids, order of axes", setting, turned(setting))


def rescaled(setting: PathSetting) -> Iterator[Comparison]:
    """Compare a setting with itself in other units of length."""
    for factor in SCALES:
        told = "absolute thresholds: offsets of rays, near clips, smallest distances, units of coefficients"
        yield _same(f"scaled/{factor:g}", told, setting, scaled(setting, factor))


def brighter(setting: PathSetting) -> Iterator[Comparison]:
    """Compare with lights a thousand times as strong, and nothing that glows."""
    if setting.light is None or np.any(getattr(setting.medium, "emission", 0.0)) or setting.surface is not None:
        return
    stronger = with_strength(setting.light, tuple(np.atleast_1d(1000.0 * np.asarray(strength(setting.light)))))
    if np.ndim(strength(setting.light)) == 0:
        stronger = with_strength(setting.light, 1000.0 * float(np.asarray(strength(setting.light))))
    told = "clamping, tone curves, roulette by absolute brightness"
    yield _same("linear-in-light", told, setting, setting.but(light=stronger), 1e-3)


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


RELATIONS: tuple[Relation, ...] = (
    constant_grids,
    equal_layers,
    equal_channels,
    channels_alone,
    integrators,
    majorants,
    moved,
    rotated,
    rescaled,
    brighter,
    sums_of_orders,
    reciprocity,
)


def comparisons(setting: PathSetting) -> list[Comparison]:
    """Return every comparison that a setting allows."""
    return [comparison for relation in RELATIONS for comparison in relation(setting)]
