"""The homogeneous medium for trackers and samplers."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.estimators.free_paths.extinction import Constant
from fogproof.estimators.grey import grey
from fogproof.scene import Medium, Ray
from fogproof.scene.shapes import Shape


class ConstantData(NamedTuple):
    """The same extinction everywhere; sigma (channels,) [1/m]."""

    sigma: np.ndarray

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        return medium.sigma[channel]


def kernel_data(medium: Medium) -> ConstantData:
    """Return the medium for kernels."""
    return ConstantData(np.array(np.atleast_1d(medium.sigma_t)))


def uniform(medium: Medium) -> np.ndarray:
    """Return the extinction where it is the same everywhere, () or (channels,) [1/m]: no tracker is needed."""
    return np.asarray(medium.sigma_t)


def shares(medium: Medium) -> tuple[float, float]:
    """Return sigma_s / sigma_t and sigma_a / sigma_t of a grey medium, 0 if it is empty."""
    sigma_a, sigma_s = grey("sigma_a", medium.sigma_a), grey("sigma_s", medium.sigma_s)
    whole = sigma_a + sigma_s
    return (sigma_s / whole, sigma_a / whole) if whole > 0 else (0.0, 0.0)


def without_absorption(medium: Medium) -> Medium:
    """Return a grey medium that scatters as much and absorbs nothing."""
    return Medium(0.0, grey("sigma_s", medium.sigma_s), medium.phase)


def along(medium: Medium, ray: Ray) -> Constant:
    """Return the extinction along a ray."""
    return Constant(grey("sigma_a", medium.sigma_a) + grey("sigma_s", medium.sigma_s))


def depth(medium: Medium, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return sigma_t t."""
    return np.atleast_1d(medium.sigma_t) * t[:, None]


def depth_towards(medium: Medium, x: np.ndarray, w: np.ndarray, way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return sigma_t times the ways, and one look each."""
    sigma = float(medium.sigma_t)
    return sigma * way if sigma > 0 else np.zeros_like(way), np.ones_like(way)


def bounds(medium: Medium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray) -> tuple[float, float]:
    """Return the least and the greatest extinction of all channels."""
    return float(np.min(medium.sigma_t)), float(np.max(medium.sigma_t))


def greatest(medium: Medium, shape: Shape) -> float:
    """Return the greatest extinction of all channels."""
    return float(np.max(medium.sigma_t))


def feature_size(medium: Medium, ray: Ray) -> float:
    """Return inf: nothing changes."""
    return np.inf
