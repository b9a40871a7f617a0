"""Relations of images that have to do with camera, film and samples."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.relations.anywhere import same
from fogproof.relations.moved import mirrored
from fogproof.relations.setting import Comparison, ImageSetting, RadianceTerm
from fogproof.scene.cameras import OneRay, Perspective
from fogproof.scene.cameras.perspective import FovAxis


def cropped(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare the middle of an image with an image of the middle alone."""
    camera: Any = setting.scene.camera
    film = camera.film
    if film.crop is not None or min(film.width, film.height) < 8:
        return
    x, y, width, height = film.width // 4, film.height // 4, film.width // 2, film.height // 2

    def middle(image: np.ndarray) -> np.ndarray:
        return image[y : y + height, x : x + width]

    part = setting.but(camera=replace(camera, film=replace(film, crop=(x, y, width, height))))
    told = "the crop window: its offset, its order of rows"
    yield Comparison("cropped", told, (RadianceTerm(setting, view=middle),), (RadianceTerm(part),))


def finer(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare pixels with the means of four, on a film of twice as many along each side."""
    camera: Any = setting.scene.camera
    film = camera.film
    if film.crop is not None or isinstance(camera, OneRay):
        return
    many = setting.but(camera=replace(camera, film=replace(film, width=2 * film.width, height=2 * film.height)))
    told = "the pixel filter, where samples stand in a pixel, half pixels"
    yield Comparison("finer-film", told, (RadianceTerm(setting),), (RadianceTerm(many, view=_by_four),))


def _by_four(image: np.ndarray) -> np.ndarray:
    rows, columns, channels = image.shape
    mean: np.ndarray = image.reshape(rows // 2, 2, columns // 2, 2, channels).mean(axis=(1, 3))
    return mean


def in_a_mirror(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare the image with that of the mirrored scene, mirrored again."""
    camera: Any = setting.scene.camera
    if camera.film.crop is not None:
        return
    other = mirrored(setting)
    told = "handedness: frames, the camera's right hand, order of corners"
    yield Comparison(
        "mirrored", told, (RadianceTerm(setting),), (RadianceTerm(other, view=lambda image: image[:, ::-1]),)
    )


def axis_otherwise(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare with the same camera, said otherwise: a farther target, a longer and tilted `up`."""
    camera: Any = setting.scene.camera
    ahead = np.subtract(camera.target, camera.origin)
    up = 3 * np.asarray(camera.up) / np.linalg.norm(camera.up) + 0.7 * ahead / np.linalg.norm(ahead)
    if np.linalg.norm(np.cross(ahead / np.linalg.norm(ahead), up)) < 0.1:
        return
    other = replace(camera, target=tuple(np.asarray(camera.origin) + 2.5 * ahead), up=tuple(up))
    told = "the camera's axes: `up` that is no unit vector and not across the axis, the distance of the target"
    yield same("camera-axes", told, setting, setting.but(camera=other))


def angles_otherwise(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare with the same angle of view, measured along the other side of the film."""
    camera: Any = setting.scene.camera
    if not isinstance(camera, Perspective):
        return
    axis: FovAxis = "y" if camera.fov_axis != "y" else "x"
    half = camera.half_width * (camera.film.height / camera.film.width if axis == "y" else 1.0)
    other = replace(camera, fov=2 * math.atan(half), fov_axis=axis)
    yield same("fov-axis", "the angle of view: which side it spans", setting, setting.but(camera=other))


def seeds(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare with renders of other seeds."""
    other, told = setting.but(copy=setting.copy + 1), "random numbers: means that depend on the seed"
    yield Comparison("seeds", told, (RadianceTerm(setting),), (RadianceTerm(other),), same_law=True)


def threads(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare two threads with five; one alone is a special case of many programs, if it ends at all."""
    first, second = (RadianceTerm(setting.but(threads=count)) for count in (2, 5))
    told = "threads: shared random numbers, pixels that are lost or written twice"
    yield Comparison("threads", told, (first,), (second,), same_law=True)


def samples(setting: ImageSetting) -> Iterator[Comparison]:
    """Compare with four times as many samples: the means are the same; that noise falls is another test of the same renders."""
    told = "bias that depends on the number of samples; noise that more samples do not lessen"
    yield same("more-samples", told, setting, setting.but(more=4))


ON_THE_FILM = (cropped, finer, in_a_mirror, axis_otherwise, angles_otherwise, seeds, threads, samples)
