"""Transmittance from the points of a ray towards a light: many short ways at once."""

from __future__ import annotations

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.scene import AnyMedium, ExponentialMedium, LinearMedium, Medium


def closed_transmittance(medium: AnyMedium, x: np.ndarray, w: np.ndarray, way: np.ndarray) -> np.ndarray:
    """Return the transmittance (n,) of a grey medium from points x (3, n) along w (3, n) for `way` (n,) [m], which may be inf."""
    match medium:
        case Medium():
            depth = _constant(float(medium.sigma_t), way)
        case LinearMedium():
            depth = _linear(float(np.asarray(medium.sigma_0)) + medium.gradient @ x, medium.gradient @ w, way)
        case ExponentialMedium():
            depth = _exponential(float(np.asarray(medium.sigma_0)) * np.exp(medium.rate @ x), medium.rate @ w, way)
        case _:
            raise UnsupportedError(f"no closed form of shadow rays in a {type(medium).__name__}", "medium")
    return np.exp(-depth)


def _constant(sigma: float, way: np.ndarray) -> np.ndarray:
    return sigma * way if sigma > 0 else np.zeros_like(way)


def _linear(near: np.ndarray, slope: np.ndarray, way: np.ndarray) -> np.ndarray:
    """The area under a line clamped at 0: a trapezium, or a triangle where the line crosses 0 on the way."""
    with np.errstate(divide="ignore", invalid="ignore"):
        far = np.where(slope == 0, near, near + slope * way)
        high = np.maximum(np.maximum(near, far), 0)
        crosses = (near < 0) != (far < 0)
        base = np.where(crosses, high / np.abs(slope), way)
        mean = np.where(crosses, 0.5 * high, np.maximum(0.5 * (near + far), 0))
        return np.where(mean > 0, mean * base, 0.0)


def _exponential(near: np.ndarray, rate: np.ndarray, way: np.ndarray) -> np.ndarray:
    """near (e^(rate way) - 1)/rate, near way where the rate is 0."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        x = rate * way
        depth = np.where(np.abs(x) > 0, near * np.expm1(x) / rate, near * way)
    return np.where(near > 0, depth, 0.0)
