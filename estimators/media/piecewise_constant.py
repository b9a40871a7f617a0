"""Plane layers for trackers and samplers."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.scene import PiecewiseConstantMedium, Ray
from fogproof.scene.shapes import Shape


class LayerData(NamedTuple):
    """Layers between boundaries (n + 1,) along axis (3,); sigma (n, channels) [1/m]."""

    sigma: np.ndarray
    boundaries: np.ndarray
    axis: np.ndarray

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        height = medium.axis[0] * x + medium.axis[1] * y + medium.axis[2] * z
        i = np.searchsorted(medium.boundaries, height, side="right") - 1
        return medium.sigma[i, channel] if 0 <= i < len(medium.sigma) else 0.0


def kernel_data(medium: PiecewiseConstantMedium) -> LayerData:
    """Return the medium for kernels."""
    sigma = np.array(medium.sigma_t.reshape(len(medium.sigma_t), -1))
    return LayerData(sigma, np.array(medium.boundaries), np.array(medium.axis))


def depth(medium: PiecewiseConstantMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return the sum over the layers of what the ray has of each, up to t."""
    inside, sigma = _inside(medium, ray.origin[:, None], ray.direction[:, None], t), medium.sigma_t
    with np.errstate(invalid="ignore"):
        parts = inside[..., None] * sigma.reshape(len(sigma), -1)
    return np.where(np.isnan(parts), 0.0, parts).sum(axis=1)  # endless vacuum


def depth_towards(
    medium: PiecewiseConstantMedium, x: np.ndarray, w: np.ndarray, way: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the same of many ways, and the number of layers that each meets."""
    inside = _inside(medium, x, w, way)
    with np.errstate(invalid="ignore"):
        parts = np.where((inside > 0) & (medium.sigma_t > 0), inside * medium.sigma_t, 0.0)
    return parts.sum(axis=-1), np.maximum((inside > 0).sum(axis=-1), 1).astype(float)


def _inside(medium: PiecewiseConstantMedium, x: np.ndarray, w: np.ndarray, way: np.ndarray) -> np.ndarray:
    """Return how far each way from x along w, (3, n) or (3, 1), runs in each layer, (n, layers) [m]."""
    height, rise = (medium.axis @ x)[:, None], (medium.axis @ w)[:, None]
    low, high = medium.boundaries[:-1], medium.boundaries[1:]
    way = way[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        one, two = (low - height) / rise, (high - height) / rise
        enter, leave = np.maximum(np.minimum(one, two), 0.0), np.minimum(np.maximum(one, two), way)
        slanted = np.maximum(leave - enter, 0.0)
        level = np.where((height >= low) & (height < high), way, 0.0)
    return np.where(rise == 0, level, slanted)


def bounds(
    medium: PiecewiseConstantMedium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> tuple[float, float]:
    """Return 0, for the vacuum around, and the greatest extinction of all layers and channels."""
    return 0.0, float(medium.sigma_t.max())


def greatest(medium: PiecewiseConstantMedium, shape: Shape) -> float:
    """Return the greatest extinction of all layers and channels."""
    return float(medium.sigma_t.max())


def feature_size(medium: PiecewiseConstantMedium, ray: Ray) -> float:
    """Return the way through the thinnest layer."""
    with np.errstate(divide="ignore"):
        return float(np.diff(medium.boundaries).min() / np.abs(medium.axis @ ray.direction))


def sources(medium: PiecewiseConstantMedium, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return albedo and emission of the layers that points x (n, 3) lie in; where no layer is, those of the nearest."""
    layer = np.searchsorted(medium.boundaries, x @ medium.axis, side="right") - 1
    layer = np.clip(layer, 0, len(medium.sigma_t) - 1)
    albedo, emission = (a[layer] if a.ndim else a for a in (medium.albedo, medium.emission))
    return albedo, emission
