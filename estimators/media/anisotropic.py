"""The medium of aligned flakes for trackers and samplers: constant along each ray, and known in closed form."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.free_paths.extinction import Constant
from fogproof.estimators.grey import grey
from fogproof.scene import AnisotropicMedium, Ray
from fogproof.scene.shapes import Shape


def extinction(medium: AnisotropicMedium, x: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return sigma sqrt(w . S w), (k, channels) [1/m]."""
    area = np.sqrt(np.maximum(np.sum((w @ medium.S) * w, axis=-1), 0.0))
    return area[:, None] * np.atleast_1d(medium.sigma)


def along(medium: AnisotropicMedium, ray: Ray) -> Constant:
    """Return the extinction along a ray."""
    w = ray.direction
    return Constant(grey("sigma", medium.sigma) * float(np.sqrt(w @ medium.S @ w)))


def depth(medium: AnisotropicMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return sigma(w) t."""
    return extinction(medium, ray.origin[None], ray.direction[None]) * t[:, None]


def depth_towards(
    medium: AnisotropicMedium, x: np.ndarray, w: np.ndarray, way: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return sigma(w) times the ways, and one look each."""
    sigma = extinction(medium, x.T, w.T)[:, 0]
    with np.errstate(invalid="ignore"):
        return np.where(sigma > 0, sigma * way, 0.0), np.ones_like(way)


def bounds(
    medium: AnisotropicMedium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the extinction along each ray, over all channels."""
    sigma = extinction(medium, origin, direction)
    return sigma.min(axis=-1), sigma.max(axis=-1)


def greatest(medium: AnisotropicMedium, shape: Shape) -> float:
    """Return the extinction of flakes seen along the widest axis."""
    return float(np.max(medium.sigma) * np.sqrt(max(np.linalg.eigvalsh(medium.S)[-1], 0.0)))


def feature_size(medium: AnisotropicMedium, ray: Ray) -> float:
    """Return inf: nothing changes along a ray."""
    return np.inf
