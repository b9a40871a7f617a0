"""Transmittance: the fraction of radiance that survives a way through the medium (Beer's law)."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.error_free import EPS, TINY, exp_minus, sum_times
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError
from fogproof.scene import Medium, Ray
from fogproof.validate import Channels, channel_count

SOURCE = "Bouguer 1729, Beer 1852; Chandrasekhar 1960, Radiative Transfer, section 7"


def optical_thickness(medium: Medium, ray: Ray) -> Reference:
    """Return tau = integral of sigma_t along the ray, dimensionless, shape R or R + (channels,).

    An empty medium has tau = 0 on every ray, the infinite one included; otherwise an infinite ray has tau = inf.
    Error: at most 1 EPS relative.
    """
    tau, low = tau_pair(medium, ray, channels_of(medium))
    with np.errstate(under="ignore"):
        return Reference(tau + low, np.where(np.isinf(tau), 0.0, EPS * tau + 2 * TINY), "sigma_t s", SOURCE)


def transmittance(medium: Medium, ray: Ray) -> Reference:
    """Return T = exp(-tau), dimensionless, shape R or R + (channels,).

    Error: at most 5 EPS relative for every tau, because tau = (sigma_a + sigma_s) s is never rounded; where T
    underflows the error is absolute, 2 TINY.
    """
    value, error = exp_minus(*tau_pair(medium, ray, channels_of(medium)))
    return Reference(value, error, "exp(-tau), tau unrounded", SOURCE)


def tau_pair(medium: Medium, ray: Ray, channels: int | None) -> tuple[np.ndarray, np.ndarray]:
    """Return tau as (value, low), each of the full shape of a result with that many channels."""
    if not isinstance(medium, Medium):
        raise InvalidValueError("medium", "must be a Medium", medium)
    if not isinstance(ray, Ray):
        raise InvalidValueError("ray", "must be a Ray", ray)
    length, shape = ray.length, ray.shape
    if channels is not None:
        length, shape = length[..., None], (*shape, channels)
    tau, low = sum_times(medium.sigma_a, medium.sigma_s, length)
    return np.broadcast_to(tau, shape), np.broadcast_to(low, shape)


def channels_of(medium: Any, **values: Channels) -> int | None:
    """Return how many channels the medium and the named values have together; None if all are grey."""
    if not isinstance(medium, Medium):
        raise InvalidValueError("medium", "must be a Medium", medium)
    return channel_count(sigma_a=medium.sigma_a, sigma_s=medium.sigma_s, emission=medium.emission, **values)
