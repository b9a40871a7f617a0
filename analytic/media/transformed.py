"""A medium moved by an affine map: its own coefficients at the place that is mapped, between the breaks of the mapped ray.

The place comes from solving for it with one step of refinement in twice the precision, so that it is off by no more than its own
rounding, whatever the matrix.
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.error_free import EPS, two_sum
from fogproof.analytic.geometry.rays import Thickness
from fogproof.analytic.media.adaptive import thickness_by_quadrature
from fogproof.analytic.media.breakpoints import Breaks, extent
from fogproof.analytic.media.coefficients import ROOM, Coefficients, Points
from fogproof.analytic.media.coefficients import coefficients as coefficients_of
from fogproof.scene import Ray
from fogproof.scene.kinds import given
from fogproof.scene.media import TransformedMedium


def coefficients(medium: TransformedMedium, at: Points) -> Coefficients:
    """Return those of the medium at the mapped points, for directions mapped as well."""
    channels = None if len(at.shape) < at.x.ndim else at.shape[-1]
    w = at.w @ np.linalg.inv(medium.to_world[:, :3]).T
    return coefficients_of(
        medium.medium, own_place(medium, at.x), w / np.linalg.norm(w, axis=-1, keepdims=True), channels
    )


def own_place(medium: TransformedMedium, x: np.ndarray) -> np.ndarray:
    """Return the points (..., 3) in the medium's own coordinates."""
    A, origin = medium.to_world[:, :3], medium.to_world[:, 3]
    inverse = np.linalg.inv(A)
    found = (x - origin) @ inverse.T
    for _ in range(2):
        rest = np.empty_like(found)
        for i in range(3):
            left = two_sum(x[..., i], -origin[i])
            for j in range(3):
                left = dd.add(left, dd.times(dd.pair(-A[i, j]), dd.pair(found[..., j])))
            rest[..., i] = left[0]
        found = found + rest @ inverse.T
    placed: np.ndarray = found
    return placed


def _own_ray(medium: TransformedMedium, ray: Ray) -> tuple[Ray, np.ndarray]:
    """Return rays in the medium's own coordinates, and its metres a metre of the world."""
    way = ray.direction @ np.linalg.inv(medium.to_world[:, :3]).T
    speed = np.linalg.norm(way, axis=-1)
    way = way / speed[..., None]
    way = way / np.linalg.norm(way, axis=-1, keepdims=True)
    return Ray(own_place(medium, ray.origin), way, ray.length * speed), speed


def thickness(medium: TransformedMedium, ray: Ray, channels: int | None) -> Thickness:
    """Return that of the medium along the mapped rays, in metres of the world.

    Error: its own, and by how much the value changes where the mapped rays move by what they are rounded by: 16 EPS of their
    coordinates and their reach, along each axis. Across a jump of the extinction that is all of it.
    """
    closed = given(medium.medium, ROOM, "thickness")
    if closed is None:
        return thickness_by_quadrature(medium, ray, channels)
    own, speed = _own_ray(medium, ray)
    found: Thickness = closed(medium.medium, own, channels)
    scale = speed if found.value.ndim == speed.ndim else speed[..., None]
    ends = extent(medium.medium, Ray(own.origin.reshape(-1, 3), own.direction.reshape(-1, 3), own.length.reshape(-1)))
    reach = np.where(np.isfinite(ends.leave), ends.leave, 0.0).reshape(speed.shape)
    shift = 16 * EPS * (np.abs(own.origin).max(axis=-1) + reach)
    error = found.error
    with np.errstate(invalid="ignore"):
        for axis in np.eye(3):
            moved = [
                closed(
                    medium.medium,
                    Ray(own.origin + (sign * shift)[..., None] * axis, own.direction, own.length),
                    channels,
                )
                for sign in (-1.0, 1.0)
            ]
            error = error + np.nan_to_num(np.max([np.abs(m.value - found.value) for m in moved], axis=0), nan=0.0)
        value = found.value / scale
        error = error / scale + 4 * EPS * np.where(np.isfinite(value), np.abs(value), 0.0)
    return Thickness(value, found.low / scale, error, found.method, found.source)


def breakpoints(medium: TransformedMedium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray) -> Breaks:
    """Return those of the medium along the mapped rays, in distances of the world."""
    ray, speed = _own_ray(medium, Ray(origin, direction, length))
    own = extent(medium.medium, ray)
    return Breaks(own.enter / speed, np.minimum(own.leave / speed, length), [t / speed[:, None] for t in own.found])
