"""Rays through convex shapes: where they enter and leave."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.scene.kinds import given
from fogproof.scene.shapes import Shape

ROOM = "fogproof.analytic.shapes"


def faces(shape: Shape) -> tuple[np.ndarray, np.ndarray] | None:
    """Return normals (k, 3) and offsets (k,) of a polyhedron: x is inside where every normal . x <= offset; None if it is none."""
    planes = given(shape, ROOM, "faces")
    return None if planes is None else planes(shape)


class Chord(NamedTuple):
    """Where rays are in a shape, as distances within [0, length], (n,): surely in [sure_start, sure_end], surely not
    outside [start, end]. Where a ray misses the shape, end = start; where that is unsure, sure_end = sure_start.
    """

    start: np.ndarray
    sure_start: np.ndarray
    sure_end: np.ndarray
    end: np.ndarray


def chord(shape: Shape, ray: FlatRays) -> Chord:
    """Return where the flattened rays are in the shape, with a margin for the rounding of all coordinates."""
    origin, direction, length = ray.origin, ray.direction, ray.length
    margin = 16 * EPS * (np.abs(origin).max(axis=1) + size_of(shape))
    reach = np.abs(np.nan_to_num(np.stack(through(shape, origin, direction, margin)), posinf=0.0, neginf=0.0))
    margin = margin + 8 * EPS * np.minimum(reach.max(axis=0), length)  # what the direction is off by, so far away
    start, end = through(shape, origin, direction, margin)
    start, end = (
        np.clip(np.nan_to_num(start, nan=0.0, posinf=np.inf, neginf=-np.inf), 0, length),
        np.minimum(end, length),
    )
    end = np.where(end > start, end, start)
    sure_start, sure_end = through(shape, origin, direction, -margin)
    sure_start, sure_end = np.clip(sure_start, start, end), np.clip(sure_end, start, end)
    missed = ~(sure_end > sure_start)
    return Chord(start, np.where(missed, start, sure_start), np.where(missed, start, sure_end), end)


def through(
    shape: Shape, origin: np.ndarray, direction: np.ndarray, margin: np.ndarray | float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Return distances at which lines (..., 3) enter and leave the shape, +-inf where they never do; NaN if they miss it.

    margin  how much larger the shape is taken, on every side [m]
    """
    origin, direction = np.broadcast_arrays(origin, direction)
    with np.errstate(all="ignore"):
        planes = faces(shape)
        if planes is None:
            enter, leave = given(shape, ROOM, "through")(shape, origin, direction, margin)
            return enter, leave
        normals, offsets = planes
        enter, leave = np.full(origin.shape[:-1], -np.inf), np.full(origin.shape[:-1], np.inf)
        for normal, offset in zip(normals, offsets, strict=True):
            room, speed = offset + margin - origin @ normal, direction @ normal
            t = room / speed
            leave = np.where(speed > 0, np.minimum(leave, t), leave)
            enter = np.where(speed < 0, np.maximum(enter, t), enter)
            enter = np.where((speed == 0) & (room < 0), np.nan, enter)
        missed = ~(enter <= leave)
        return np.where(missed, np.nan, enter), np.where(missed, np.nan, leave)


def changes_of_face(shape: Shape, ray: FlatRays, position: tuple[float, float, float]) -> np.ndarray:
    """Return (n, m) distances at which the way from a ray to a point leaves a polyhedron by another face; m = 0 for others.

    A way from x to p crosses face i after the share room_i(x)/(room_i(x) - room_i(p)) of it, with room = offset - normal . x,
    linear along the ray: two shares are equal at one place.
    """
    planes = faces(shape)
    if planes is None or len(planes[1]) < 2:
        return np.empty((len(ray.origin), 0))
    normals, offsets = planes
    beyond, room = offsets - normals @ np.array(position), offsets - ray.origin @ normals.T
    speed = -(ray.direction @ normals.T)
    i, j = np.triu_indices(len(offsets), 1)
    with np.errstate(all="ignore"):
        return -(room[:, i] * beyond[j] - room[:, j] * beyond[i]) / (speed[:, i] * beyond[j] - speed[:, j] * beyond[i])


def size_of(shape: Shape) -> float:
    """Return the largest coordinate that the shape is given by, or a bound: the sum of all its numbers."""
    size = given(shape, ROOM, "size")
    return float(size(shape) if size else sum(np.abs(np.asarray(value, float)).sum() for value in vars(shape).values()))


def contains(shape: Shape, point: np.ndarray) -> np.ndarray:
    """Return whether points (..., 3) are in the closed shape."""
    planes = faces(shape)
    if planes is None:  # a line through the point is inside on both sides of it
        enter, leave = through(shape, point, np.array([1.0, 0.0, 0.0]))
        return (enter <= 0) & (leave >= 0)
    normals, offsets = planes
    return np.all(point @ normals.T <= offsets, axis=-1)
