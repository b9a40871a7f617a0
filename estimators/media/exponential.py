"""The exponentially graded medium for trackers and samplers."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.estimators.free_paths.extinction import Exponential, Extinction, LookedUp
from fogproof.estimators.grey import grey
from fogproof.estimators.media.gradients import rows, slopes
from fogproof.estimators.paths.extremes import extremes
from fogproof.estimators.tracking.medium_data import grey_medium, look_ups
from fogproof.scene import ExponentialMedium, Ray
from fogproof.scene.shapes import Shape


class ExponentialData(NamedTuple):
    """sigma_0 exp(rate . x); sigma_0 (channels,) [1/m], rate (channels, 3) [1/m]."""

    sigma_0: np.ndarray
    rate: np.ndarray

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        k = medium.rate
        return medium.sigma_0[channel] * np.exp(k[channel, 0] * x + k[channel, 1] * y + k[channel, 2] * z)


def kernel_data(medium: ExponentialMedium) -> ExponentialData:
    """Return the medium for kernels."""
    return ExponentialData(*rows(medium.sigma_0, medium.rate, medium.channels))


def along(medium: ExponentialMedium, ray: Ray) -> Extinction:
    """Return the extinction along a ray."""
    if medium.rate.ndim > 1:
        return LookedUp(grey_medium(medium), ray)
    at_origin = grey("sigma_0", medium.sigma_0) * float(np.exp(medium.rate @ ray.origin))
    return Exponential(at_origin, float(medium.rate @ ray.direction))


def depth(medium: ExponentialMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return the integral of an exponential from 0 to t."""
    (here, rate), t = slopes(0.0, medium.rate, ray), t[:, None]
    x = rate * t
    with np.errstate(invalid="ignore"):
        growth = np.where(x == 0, 1.0, np.expm1(x) / np.where(x == 0, 1.0, x))
    return np.atleast_1d(medium.sigma_0) * np.exp(here) * growth * t


def depth_towards(
    medium: ExponentialMedium, x: np.ndarray, w: np.ndarray, way: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return near (e^(rate way) - 1)/rate, near way where the rate is 0."""
    near, rate = float(np.asarray(medium.sigma_0)) * np.exp(medium.rate @ x), medium.rate @ w
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        power = rate * way
        depth = np.where(np.abs(power) > 0, near * np.expm1(power) / rate, near * way)
    return np.where(near > 0, depth, 0.0), np.ones_like(way)


def bounds(
    medium: ExponentialMedium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return what is at the ends of each ray."""
    field, ends = look_ups(medium), (origin, origin + length[:, None] * direction)
    sigma = np.concatenate([field(end, direction) for end in ends], axis=-1)
    return sigma.min(axis=-1), sigma.max(axis=-1)


def greatest(medium: ExponentialMedium, shape: Shape) -> float:
    """Return what is at the point of the shape that is farthest along the rate."""
    corners = np.concatenate([extremes(vector, shape) for vector in np.atleast_2d(medium.rate)])
    return float(look_ups(medium)(corners, np.zeros_like(corners)).max())


def feature_size(medium: ExponentialMedium, ray: Ray) -> float:
    """Return the scale height."""
    with np.errstate(divide="ignore"):
        return float(1 / np.abs(medium.rate @ ray.direction).max())
