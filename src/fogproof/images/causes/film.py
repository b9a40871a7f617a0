"""The film: flipped, turned, shifted, blurred, or another angle of view."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from fogproof.images.causes.image_cause import ImageCause, Sight, fixed

AXES = ("x", "y", "smaller", "larger", "diagonal")


def hypotheses(sight: Sight) -> Iterator[ImageCause]:
    """Yield what is wrong with the film."""
    whole, rows, columns = sight.found.reference, sight.rows, sight.columns
    if not np.ptp(whole) > 0:
        return
    flipped = {
        "flipped-columns": (whole[:, ::-1], "the image is mirrored, left for right"),
        "flipped-rows": (whole[::-1], "the image is upside down, row 0 is the lowest"),
        "turned": (whole[::-1, ::-1], "the image is turned by half a turn"),
    }
    if whole.shape[0] == whole.shape[1]:
        flipped["transposed"] = (np.swapaxes(whole, 0, 1), "rows and columns are exchanged")
    for cause, (other, words) in flipped.items():
        yield fixed(cause, partial(_at, other, rows, columns), words)
    yield ImageCause(
        "shifted",
        lambda p: sight.instead(sight.scene, -p[0], -p[1]),
        lambda p: f"the image is shifted by {p[0]:+.3g} pixels to the right and {p[1]:+.3g} downwards",
        ((0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)),
        -20,
        20,
    )
    camera: Any = sight.scene.camera
    if hasattr(camera, "fov"):
        yield from _angles(sight, camera)
    yield ImageCause(
        "filter",
        lambda p: _blurred(whole, float(p[0]))[rows, columns],
        lambda p: f"the image is blurred: a filter of standard deviation {p[0]:.3g} pixels on top of the box",
        ((0.3,), (1.0,), (3.0,)),
        0.01,
        30,
    )


def _angles(sight: Sight, camera: Any) -> Iterator[ImageCause]:
    for axis in AXES:
        other = replace(camera, fov_axis=axis)
        if abs(other.half_width / camera.half_width - 1) > 1e-9:
            scene = replace(sight.scene, camera=other)
            yield fixed("fov-axis", partial(sight.instead, scene), f"the angle of view spans the axis {axis!r}")

    def zoomed(p: np.ndarray) -> np.ndarray:
        fov = 2 * np.arctan(np.tan(0.5 * camera.fov) * p[0])
        return sight.instead(replace(sight.scene, camera=replace(camera, fov=float(fov))))

    def words(p: np.ndarray) -> str:
        return f"the image shows {p[0]:.4g} times the width of the film"

    yield ImageCause("zoom", zoomed, words, ((0.9,), (1.1,)), 0.1, 10)


def _at(image: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    return np.asarray(image[rows, columns])


def _blurred(x: np.ndarray, deviation: float) -> np.ndarray:
    from scipy.ndimage import gaussian_filter

    return np.asarray(gaussian_filter(x, (deviation, deviation, 0), mode="nearest"))
