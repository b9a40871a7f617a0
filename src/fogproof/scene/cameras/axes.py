"""What every camera that looks somewhere needs: an axis, and what is up."""

from __future__ import annotations

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.validate import as_float_array, one_point

PARALLEL = 1e-9
"""Sine of the angle between axis and `up` below which nothing is up."""


def checked_axes(origin: object, target: object, up: object) -> tuple[tuple[float, float, float], ...]:
    """Return origin, target and up as points, or say which of them does not make an axis."""
    points = one_point("origin", origin), one_point("target", target), one_point("up", up)
    axis = np.subtract(points[1], points[0])
    length, height = np.linalg.norm(axis), np.linalg.norm(points[2])
    if not 0 < length < np.inf:
        raise InvalidValueError("target", "must differ from origin", target)
    if not 0 < height < np.inf or np.linalg.norm(np.cross(axis / length, np.array(points[2]) / height)) < PARALLEL:
        raise InvalidValueError("up", "must not be parallel to the axis from origin to target", up)
    return points


def checked_wall(wall: object) -> float:
    """Return the distance of the wall along the axis: > 0, or inf."""
    array = as_float_array("wall", wall)
    if array.ndim or not array > 0:
        raise InvalidValueError("wall", "must be > 0 [m], along the axis", wall, "inf means none")
    return float(array)
