"""Rays through convex shapes: where they enter and leave."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.scene.shapes import Ball, Box, HalfSpace, Shape, Slab, Unbounded


def faces(shape: Shape) -> tuple[np.ndarray, np.ndarray]:
    """Return normals (k, 3) and offsets (k,) of a polyhedron: x is inside where every normal . x <= offset."""
    match shape:
        case HalfSpace(point, normal):
            normals = np.array([normal])
            return normals, normals @ np.array(point)
        case Slab(point, normal, thickness):
            offset = float(np.dot(normal, point))
            return np.array([normal, np.negative(normal)]), np.array([offset, thickness - offset])
        case Box(lower, upper):
            return np.concatenate([np.eye(3), -np.eye(3)]), np.concatenate([upper, np.negative(lower)])
    return np.empty((0, 3)), np.empty(0)


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
    if isinstance(shape, Unbounded):
        zero = np.zeros(length.shape)
        return Chord(zero, zero, length, length)
    margin = 32 * EPS * (np.abs(origin).max(axis=1) + _size(shape))
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
        if isinstance(shape, Ball):
            q = origin - np.array(shape.center)
            middle = -np.sum(q * direction, axis=-1)
            distance = np.linalg.norm(q + middle[..., None] * direction, axis=-1)
            radius = shape.radius + margin
            half = np.sqrt((radius - distance) * (radius + distance))
            return middle - half, middle + half
        normals, offsets = faces(shape)
        enter, leave = np.full(origin.shape[:-1], -np.inf), np.full(origin.shape[:-1], np.inf)
        for normal, offset in zip(normals, offsets, strict=True):
            room, speed = offset + margin - origin @ normal, direction @ normal
            t = room / speed
            leave = np.where(speed > 0, np.minimum(leave, t), leave)
            enter = np.where(speed < 0, np.maximum(enter, t), enter)
            enter = np.where((speed == 0) & (room < 0), np.nan, enter)
        missed = ~(enter <= leave)
        return np.where(missed, np.nan, enter), np.where(missed, np.nan, leave)


def _size(shape: Shape) -> float:
    """Return the largest coordinate that the shape is given by."""
    match shape:
        case Ball(center, radius):
            return float(np.abs(center).max() + radius)
        case HalfSpace(point, _):
            return float(np.abs(point).max())
        case Slab(point, _, thickness):
            return float(np.abs(point).max() + thickness)
        case Box(lower, upper):
            return float(np.abs([lower, upper]).max())
    return 0.0


def contains(shape: Shape, point: np.ndarray) -> np.ndarray:
    """Return whether points (..., 3) are in the closed shape."""
    if isinstance(shape, Ball):
        return np.linalg.norm(point - np.array(shape.center), axis=-1) <= shape.radius
    normals, offsets = faces(shape)
    return np.all(point @ normals.T <= offsets, axis=-1)
