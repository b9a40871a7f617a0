"""What every closed form of the optical thickness returns, and the shapes they work in."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene import AnyMedium, Ray
from fogproof.validate import Channels, channel_count


class Thickness(NamedTuple):
    """Optical thickness as the pair (value, low), with |value + low - tau| <= error."""

    value: np.ndarray
    low: np.ndarray
    error: np.ndarray
    method: str
    source: str


class Rays(NamedTuple):
    """Rays with an axis for the channels, if there are any: origin and direction (..., 1, 3), length (..., 1).

    Without channels they are (..., 3) and (...). `shape` is that of the result.
    """

    origin: np.ndarray
    direction: np.ndarray
    length: np.ndarray
    shape: tuple[int, ...]


def rays_with_channels(ray: Ray, channels: int | None) -> Rays:
    """Return the rays, with an axis for the channels unless the result is grey."""
    if not isinstance(ray, Ray):
        raise InvalidValueError("ray", "must be a Ray", ray)
    if channels is None:
        return Rays(ray.origin, ray.direction, ray.length, ray.shape)
    return Rays(ray.origin[..., None, :], ray.direction[..., None, :], ray.length[..., None], (*ray.shape, channels))


def channels_of(medium: Any, **values: Channels) -> int | None:
    """Return how many channels the medium and the named values have together; None if all are grey."""
    if not isinstance(medium, AnyMedium):
        raise InvalidValueError("medium", "must be a medium", medium, "for example Medium(sigma_a, sigma_s)")
    return channel_count(medium=(0.0,) * medium.channels if medium.channels else 0.0, **values)
