"""The linearly graded medium for trackers and samplers."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.estimators.free_paths.extinction import Extinction, Linear, LookedUp
from fogproof.estimators.grey import grey
from fogproof.estimators.media.gradients import rows, slopes
from fogproof.estimators.paths.extremes import extremes
from fogproof.estimators.tracking.medium_data import grey_medium, look_ups
from fogproof.scene import LinearMedium, Ray
from fogproof.scene.shapes import Shape


class LinearData(NamedTuple):
    """max(0, sigma_0 + gradient . x); sigma_0 (channels,) [1/m], gradient (channels, 3) [1/m^2]."""

    sigma_0: np.ndarray
    gradient: np.ndarray

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        g = medium.gradient
        return max(0.0, medium.sigma_0[channel] + (g[channel, 0] * x + g[channel, 1] * y + g[channel, 2] * z))


def kernel_data(medium: LinearMedium) -> LinearData:
    """Return the medium for kernels."""
    return LinearData(*rows(medium.sigma_0, medium.gradient, medium.channels))


def along(medium: LinearMedium, ray: Ray) -> Extinction:
    """Return the extinction along a ray."""
    gradient = medium.gradient
    if gradient.ndim > 1:
        return LookedUp(grey_medium(medium), ray)
    return Linear(grey("sigma_0", medium.sigma_0) + float(gradient @ ray.origin), float(gradient @ ray.direction))


def depth(medium: LinearMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return the integral of max(0, a + b s) from 0 to t: a trapezoid between the points where it is positive."""
    (a, b), t = slopes(medium.sigma_0, medium.gradient, ray), t[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        zero = -a / b
    start = np.where((a < 0) & (b > 0), np.minimum(zero, t), np.where(a < 0, t, 0.0))
    stop = np.where((a > 0) & (b < 0), np.minimum(zero, t), t)
    return (stop - start) * (a + 0.5 * b * (start + stop))


def depth_towards(medium: LinearMedium, x: np.ndarray, w: np.ndarray, way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the area under a line clamped at 0: a trapezium, or a triangle where the line crosses 0 on the way."""
    near, slope = float(np.asarray(medium.sigma_0)) + medium.gradient @ x, medium.gradient @ w
    with np.errstate(divide="ignore", invalid="ignore"):
        far = np.where(slope == 0, near, near + slope * way)
        high = np.maximum(np.maximum(near, far), 0)
        crosses = (near < 0) != (far < 0)
        base = np.where(crosses, high / np.abs(slope), way)
        mean = np.where(crosses, 0.5 * high, np.maximum(0.5 * (near + far), 0))
        return np.where(mean > 0, mean * base, 0.0), np.ones_like(way)


def bounds(
    medium: LinearMedium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return what is at the ends of each ray."""
    field, ends = look_ups(medium), (origin, origin + length[:, None] * direction)
    sigma = np.concatenate([field(end, direction) for end in ends], axis=-1)
    return sigma.min(axis=-1), sigma.max(axis=-1)


def greatest(medium: LinearMedium, shape: Shape) -> float:
    """Return what is at the point of the shape that is farthest along the gradient."""
    corners = np.concatenate([extremes(vector, shape) for vector in np.atleast_2d(medium.gradient)])
    return float(look_ups(medium)(corners, np.zeros_like(corners)).max())


def feature_size(medium: LinearMedium, ray: Ray) -> float:
    """Return inf: midpoints are exact."""
    return np.inf
