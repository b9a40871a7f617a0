"""Relations of rays and of images alike: what each changes, and what must come of it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fogproof.relations.moved import brightened, scaled, translated, turned
from fogproof.relations.setting import Comparison, ImageSetting, PathSetting, RadianceTerm
from fogproof.scene import Medium, PiecewiseConstantMedium, VoxelGrid
from fogproof.scene.shapes import Box, Slab

AnySetting = PathSetting | ImageSetting

FAR = (1.0, 30.0, 500.0)
"""How far everything is moved [m]: offsets in absolute units show at one of them."""

SCALES = (100.0, 1e-3)


def same(name: str, isolates: str, first: AnySetting, second: AnySetting, factor: float = 1.0) -> Comparison:
    """Return the comparison of two settings that must show the same, the second times a factor."""
    return Comparison(name, isolates, (RadianceTerm(first),), (RadianceTerm(second, factor),))


def constant_grids(setting: AnySetting) -> Iterator[Comparison]:
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
        yield same(f"constant-grid/{interpolation}", told, setting, setting.but(medium=grid))


def equal_layers(setting: AnySetting) -> Iterator[Comparison]:
    """Compare a slab with the same slab cut into layers that touch."""
    medium, shape = setting.medium, setting.shape
    if not (isinstance(medium, Medium) and isinstance(shape, Slab) and medium.channels is None):
        return
    normal = np.asarray(shape.normal)
    top = float(normal @ np.asarray(shape.point))
    cuts = top - shape.thickness * np.array([1.0, 0.6, 0.25, 0.0])
    layers = PiecewiseConstantMedium(
        cuts,
        np.full(3, float(medium.sigma_t)),
        normal,
        float(medium.albedo),
        medium.phase,
        float(np.asarray(medium.emission)),
    )
    told = "boundaries between equal media: paths that stop, bounce or are counted there"
    yield same("cut-slab", told, setting, setting.but(medium=layers))


def equal_channels(setting: AnySetting) -> Iterator[Comparison]:
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
    channel = None if isinstance(setting, ImageSetting) else 1  # of an image all are seen
    coloured = RadianceTerm(setting.but(medium=three), 1.0, channel)
    told = "the colours of a path: pdfs and weights of channels"
    yield Comparison("equal-channels", told, (RadianceTerm(setting),), (coloured,))


def channels_alone(setting: AnySetting) -> Iterator[Comparison]:
    """Compare each channel of a coloured medium with the grey medium it sees."""
    medium = setting.medium
    if not isinstance(medium, Medium) or medium.channels is None:
        return
    for c in range(medium.channels):
        alone = setting.alone(c)
        told = "the colours of a path: the pdf of one channel used for all, a majorant of one channel"
        yield Comparison(f"channel-alone/{c}", told, (RadianceTerm(setting, 1.0, c),), (RadianceTerm(alone),))


def moved(setting: AnySetting) -> Iterator[Comparison]:
    """Compare a setting with itself elsewhere."""
    for far in FAR:
        told = "transforms that one part ignores, offsets of rays that depend on the coordinates"
        yield same(f"moved/{far:g}", told, setting, translated(setting, (far, -far, 0.5 * far)))


def rotated(setting: AnySetting) -> Iterator[Comparison]:
    """Compare a setting with itself turned."""
    yield same("turned", "frames of directions, transforms of grids, order of axes", setting, turned(setting))


def rescaled(setting: AnySetting) -> Iterator[Comparison]:
    """Compare a setting with itself in other units of length."""
    for factor in SCALES:
        told = "absolute thresholds: offsets of rays, near clips, smallest distances, units of coefficients"
        yield same(f"scaled/{factor:g}", told, setting, scaled(setting, factor))


def brighter(setting: AnySetting) -> Iterator[Comparison]:
    """Compare with everything that shines a thousand times as strong."""
    if setting.surface is None:
        told = "clamping, tone curves, roulette by absolute brightness"
        yield same("linear-in-light", told, setting, brightened(setting, 1000.0), 1e-3)


ANYWHERE = (
    constant_grids,
    equal_layers,
    equal_channels,
    channels_alone,
    moved,
    rotated,
    rescaled,
    brighter,
)
