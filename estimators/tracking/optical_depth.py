"""The estimators' own optical depth along a ray, for the densities they claim: closed forms, cells, or fine quadrature."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.tracking.marching import feature_size
from fogproof.estimators.tracking.medium_data import box, look_ups
from fogproof.estimators.tracking.tracked import clip_to_box
from fogproof.scene import AnyMedium, ExponentialMedium, LinearMedium, Medium, PiecewiseConstantMedium, Ray, VoxelGrid

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)


def path_density(medium: AnyMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return sigma_t(t) T(t) along one ray, (n, channels) [1/m]."""
    x = ray.origin + t[:, None] * ray.direction
    lower, upper = box(medium)
    inside = np.all((x >= lower) & (x <= upper), axis=-1)
    sigma = look_ups(medium)(x, np.broadcast_to(ray.direction, x.shape))
    return np.where(inside[:, None], sigma, 0.0) * np.exp(-optical_depth(medium, ray, t))


def optical_depth(medium: AnyMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return the optical depth from the start of one ray to distances t (n,), (n, channels), dimensionless.

    Exact but for rounding, except in procedural media: there 12-point Gauss-Legendre quadrature in panels as long as the
    smallest feature of the medium.
    """
    along = t[:, None]
    match medium:
        case Medium():
            return np.atleast_1d(medium.sigma_t) * along
        case LinearMedium():
            return _linear(*_along(medium.sigma_0, medium.gradient, ray), along)
        case ExponentialMedium():
            here, rate = _along(0.0, medium.rate, ray)
            x = rate * along
            with np.errstate(invalid="ignore"):
                growth = np.where(x == 0, 1.0, np.expm1(x) / np.where(x == 0, 1.0, x))
            return np.atleast_1d(medium.sigma_0) * np.exp(here) * growth * along
        case PiecewiseConstantMedium():
            return _layers(medium, ray, t)
        case VoxelGrid():
            from fogproof.estimators.tracking.regular import regular_tracking

            rays = Ray(ray.origin, ray.direction, np.maximum(t, np.finfo(float).tiny))
            return np.stack(
                [regular_tracking(medium, rays, channel=c).tau for c in range(medium.channels or 1)], axis=-1
            )
    return _quadrature(medium, ray, t)


def _along(value: float | tuple[float, ...], vectors: np.ndarray, ray: Ray) -> tuple[np.ndarray, np.ndarray]:
    """Return the value at the start of the ray and its slope along it, (channels,) each."""
    vectors = np.atleast_2d(vectors)
    return value + vectors @ ray.origin, vectors @ ray.direction


def _linear(a: np.ndarray, b: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the integral of max(0, a + b s) from 0 to t: a trapezoid between the points where it is positive."""
    with np.errstate(divide="ignore", invalid="ignore"):
        zero = -a / b
    start = np.where((a < 0) & (b > 0), np.minimum(zero, t), np.where(a < 0, t, 0.0))
    stop = np.where((a > 0) & (b < 0), np.minimum(zero, t), t)
    return (stop - start) * (a + 0.5 * b * (start + stop))


def _layers(medium: PiecewiseConstantMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    height, rise = float(medium.axis @ ray.origin), float(medium.axis @ ray.direction)
    low, high = medium.boundaries[:-1], medium.boundaries[1:]
    if rise == 0:
        inside = ((height >= low) & (height < high)) * t[:, None]
    else:
        one, two = (low - height) / rise, (high - height) / rise
        enter, leave = np.maximum(np.minimum(one, two), 0.0), np.minimum(np.maximum(one, two), t[:, None])
        inside = np.maximum(leave - enter, 0.0)
    return inside @ medium.sigma_t.reshape(len(low), -1)


def _quadrature(medium: AnyMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    lower, upper = box(medium)
    enter, leave = clip_to_box(ray.origin[None], ray.direction[None], ray.length[None], lower, upper)
    start, stop = float(enter[0]), float(leave[0])
    panels = max(1, int(np.ceil((stop - start) / feature_size(medium, ray))))
    edges = np.linspace(start, stop, panels + 1)
    inside = np.clip(t, start, stop)
    panel = np.clip(np.searchsorted(edges, inside, side="right") - 1, 0, panels - 1)
    whole = _gauss(medium, ray, edges[:-1], edges[1:])
    before = np.concatenate([np.zeros((1, whole.shape[1])), np.cumsum(whole, axis=0)])
    return before[panel] + _gauss(medium, ray, edges[panel], inside)


def _gauss(medium: AnyMedium, ray: Ray, start: np.ndarray, stop: np.ndarray) -> np.ndarray:
    """Return the integrals of sigma_t from start to stop (n,) along one ray, (n, channels)."""
    half = 0.5 * (stop - start)
    t = (start + half)[:, None] + half[:, None] * NODES
    x = (ray.origin + t[..., None] * ray.direction).reshape(-1, 3)
    sigma = look_ups(medium)(x, np.broadcast_to(ray.direction, x.shape)).reshape(*t.shape, -1)
    return half[:, None] * np.einsum("nkc,k->nc", sigma, WEIGHTS)
