"""A sum of Gaussian puffs for trackers and samplers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from fogproof.estimators.inversion import inverted
from fogproof.scene import Ray
from fogproof.scene.media.gaussian_puffs import GaussianPuffs
from fogproof.scene.shapes import Shape

NODES = 513
"""Of the table from which Newton's method starts."""


class PuffData(NamedTuple):
    """density exp(-fall |x - centre|^2) summed; centres (n, 3) [m], fall (n,) [1/m^2], density (n,) [1/m]."""

    centers: np.ndarray
    fall: np.ndarray
    density: np.ndarray

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        total = 0.0
        for k in range(len(medium.fall)):
            dx, dy, dz = x - medium.centers[k, 0], y - medium.centers[k, 1], z - medium.centers[k, 2]
            total += medium.density[k] * np.exp(-medium.fall[k] * (dx * dx + dy * dy + dz * dz))
        return total


def kernel_data(medium: GaussianPuffs) -> PuffData:
    """Return the medium for kernels."""
    return PuffData(np.array(medium.centers), 0.5 / medium.widths**2, np.array(medium.densities))


@dataclass(frozen=True, eq=False)
class Bumps:
    """Gaussians along one ray: peak exp(-(t - middle)^2/(2 width^2)) summed, (puffs,) each [1/m, m, m]."""

    peak: np.ndarray
    middle: np.ndarray
    width: np.ndarray

    def sigma(self, t: np.ndarray) -> np.ndarray:
        """Return the extinction coefficient."""
        u = (np.asarray(t)[..., None] - self.middle) / self.width
        with np.errstate(under="ignore"):
            return np.exp(-0.5 * u * u) @ self.peak

    def depth(self, t: np.ndarray) -> np.ndarray:
        """Return the optical depth: what each Gaussian has below t, less what it has below 0."""
        from scipy.special import ndtr

        whole = np.sqrt(2 * np.pi) * self.peak * self.width
        before = ndtr(-self.middle / self.width)
        return (ndtr((np.asarray(t)[..., None] - self.middle) / self.width) - before) @ whole

    def _guess(self, depth: np.ndarray, end: float) -> np.ndarray:
        """Return about where a depth is reached, from a table of it up to where the last Gaussian ends."""
        t = np.linspace(0.0, end, NODES)
        return np.interp(depth, self.depth(t), t)

    def reach(self, depth: np.ndarray) -> np.ndarray:
        """Return the distance by Newton's method between brackets that close around it, inf if the depth is never reached."""
        wanted = np.asarray(depth, dtype=float).ravel()
        reached = np.full_like(wanted, np.inf)
        left = np.flatnonzero(self.depth(np.array(np.inf)) >= wanted)
        end = max(float((self.middle + 40 * self.width).max()), 0.0)
        low, high = np.zeros(len(left)), np.full(len(left), end)

        def at(t: np.ndarray, which: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return self.depth(t) - wanted[left[which]], self.sigma(t)

        reached[left] = inverted(at, self._guess(wanted[left], end), low, high)
        return reached.reshape(np.shape(depth))


def along(medium: GaussianPuffs, ray: Ray) -> Bumps:
    """Return the extinction along a ray."""
    offset = medium.centers - ray.origin
    middle = offset @ ray.direction
    p2 = np.sum((offset - middle[:, None] * ray.direction) ** 2, axis=-1)
    with np.errstate(under="ignore"):
        peak = medium.densities * np.exp(-p2 / (2 * medium.widths**2))
    return Bumps(peak, middle, np.array(medium.widths))


def depth(medium: GaussianPuffs, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return the optical depth up to t, the same in every channel."""
    return np.repeat(along(medium, ray).depth(t)[:, None], medium.channels or 1, axis=1)


def depth_towards(
    medium: GaussianPuffs, x: np.ndarray, w: np.ndarray, way: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the optical depth of many ways, and one look each."""
    from scipy.special import ndtr

    total = np.zeros_like(way)
    for center, width, density in zip(medium.centers, medium.widths, medium.densities, strict=True):
        offset = center[:, None] - x
        middle = np.sum(offset * w, axis=0)
        p2 = np.sum((offset - middle * w) ** 2, axis=0)
        peak = density * np.exp(-p2 / (2 * width**2)) * np.sqrt(2 * np.pi) * width
        total += peak * (ndtr((way - middle) / width) - ndtr(-middle / width))
    return total, np.ones_like(way)


def bounds(
    medium: GaussianPuffs, origin: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return 0 and the sum of what each puff has where the ray is nearest to it, as if that were one place."""
    offset = medium.centers - origin[:, None, :]
    nearest = np.clip(np.sum(offset * direction[:, None, :], axis=-1), 0.0, length[:, None])
    square = np.sum((offset - nearest[..., None] * direction[:, None, :]) ** 2, axis=-1)
    with np.errstate(under="ignore"):
        high = np.exp(-square / (2 * medium.widths**2)) @ medium.densities
    return np.zeros_like(high), high * (1 + 1e-12)


def greatest(medium: GaussianPuffs, shape: Shape) -> float:
    """Return the sum of all densities, which is reached if all puffs have one centre."""
    return float(np.sum(medium.densities))


def feature_size(medium: GaussianPuffs, ray: Ray) -> float:
    """Return the width of the smallest puff."""
    return float(medium.widths.min())
