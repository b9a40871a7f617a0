"""The axes of a camera: right-handed, so that what is on the right of who looks is on the right of the image."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Frame(NamedTuple):
    """Unit vectors (3,): to the right, upwards, and along the axis."""

    right: np.ndarray
    up: np.ndarray
    ahead: np.ndarray


def frame(
    origin: tuple[float, float, float], target: tuple[float, float, float], up: tuple[float, float, float]
) -> Frame:
    """Return the axes of a camera at `origin` that looks at `target`, with `up` upwards as far as that is across the axis."""
    ahead = _unit(np.subtract(target, origin))
    right = _unit(np.cross(ahead, _unit(np.asarray(up))))
    return Frame(right, np.cross(right, ahead), ahead)


def _unit(vector: np.ndarray) -> np.ndarray:
    scaled = vector / np.max(np.abs(vector))
    unit: np.ndarray = scaled / np.sqrt(scaled @ scaled)
    return unit
