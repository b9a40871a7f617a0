"""Geometry that flat lights share: points seen from their plane, and where rays meet it."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.airlight.incident import Extent
from fogproof.analytic.geometry.flat_rays import FlatRays


def plane_extent(
    ray: FlatRays, center: np.ndarray, normal: np.ndarray, reach: float, inside: np.ndarray, t: np.ndarray
) -> Extent:
    """Return how a flat light lies to rays that cross its plane at t (n,), where `inside` it says whether they meet it."""
    ends = np.where((t > 0) & inside, t, np.inf)
    foot = np.sum((center - ray.origin) * ray.direction, axis=1)
    nearest = np.linalg.norm(ray.origin + foot[:, None] * ray.direction - center, axis=1)
    return Extent(ends, t[:, None], foot, np.hypot(nearest, reach))


def crossing(ray: FlatRays, center: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the distances (n,) at which rays cross a plane, inf where they do not, and the points there from `center`."""
    with np.errstate(all="ignore"):
        t = ((center - ray.origin) @ normal) / (ray.direction @ normal)
    t = np.where(np.isfinite(t), t, np.inf)
    there = np.where(np.isfinite(t), t, 0.0)[:, None]
    return t, ray.origin + there * ray.direction - center
