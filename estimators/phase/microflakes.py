"""Directions scattered by SGGX microflakes: a flake as it is seen, then its reflection (Heitz et al. 2015, section 4).

With the Cholesky factor S = L L^T a flake has the normal L p/|L p| for a unit vector p, and seen along the back direction i the p
are distributed as the cosine about L^T i: a point of a disk lifted to a hemisphere.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import UnitSphere
from fogproof.scene.phase import Microflakes

Axis = tuple[float, float, float]

NODES = 8.0, 14.0, 160.0
"""Nodes along each angle of the density of diffuse flakes: so many, so many more divided by their flatness, at most so many."""

BLOCK = 1 << 19
"""Nodes at a time."""


@dataclass(frozen=True, eq=False)
class MicroflakeDirections:
    """Directions scattered by flakes that light along the unit vector `w_in` meets."""

    flakes: Microflakes
    w_in: Axis = (0.0, 0.0, 1.0)
    domain: ClassVar[UnitSphere] = UnitSphere()

    @property
    def dimensions(self) -> int:
        """Uniforms a sample: two for the flake, two more for a diffuse reflection."""
        return 2 if self.flakes.reflection == "specular" else 4

    @cached_property
    def _factor(self) -> np.ndarray:
        return np.linalg.cholesky(self.flakes.S / np.trace(self.flakes.S))

    @cached_property
    def _back(self) -> np.ndarray:
        return -np.asarray(self.w_in)

    @cached_property
    def _nodes(self) -> int:
        """Enough for ten digits or so: |L p| has zeros where the angle has the imaginary part of the flakes' flatness."""
        areas = np.linalg.svd(self._factor, compute_uv=False)
        first, more, most = NODES
        return int(min(first + more * areas[0] / areas[-1], most))

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 2) or (n, 4) to directions (n, 3) and their pdf [1/sr]."""
        x = self.drawn(u)
        return Draw(x, self.pdf(x))

    def drawn(self, u: np.ndarray) -> np.ndarray:
        """Map uniforms to directions alone: the density of diffuse flakes costs far more than they do."""
        seen = np.tile(self._factor.T @ self._back, (len(u), 1))
        normal = _hemisphere(seen / np.linalg.norm(seen, axis=1)[:, None], u[:, 0], u[:, 1]) @ self._factor.T
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        if self.flakes.reflection == "specular":
            x = 2 * (normal @ self._back)[:, None] * normal - self._back
        else:
            x = _hemisphere(normal, u[:, 2], u[:, 3])
        return x / np.linalg.norm(x, axis=1)[:, None]

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the phase function at directions x (n, 3) [1/sr]."""
        return self._mirrored(x) if self.flakes.reflection == "specular" else self._diffused(x)

    def _mirrored(self, x: np.ndarray) -> np.ndarray:
        """D(h)/(4 sigma), D(h) = 1/(pi sqrt(det S) (h . S^-1 h)^2) at the normal h halfway, by the Cholesky factor."""
        h = x + self._back
        h /= np.maximum(np.linalg.norm(h, axis=1), 1e-300)[:, None]
        z = np.linalg.solve(self._factor, h.T)
        D = 1 / (np.pi * np.prod(np.diag(self._factor)) * np.sum(z * z, axis=0) ** 2)
        value: np.ndarray = D / (4 * np.linalg.norm(self._factor.T @ self._back))
        return value

    def _diffused(self, x: np.ndarray) -> np.ndarray:
        """The mean of max(x . m, 0)/pi over visible normals m: over p on both sides of the arc on which x . L p is 0."""
        L = self._factor
        seen = L.T @ self._back
        area = np.linalg.norm(seen)
        value, nodes = np.empty(len(x)), self._nodes
        step = max(1, BLOCK // nodes**2)
        for start in range(0, len(x), step):
            some = slice(start, start + step)
            value[some] = _both_sides(L, seen / area, x[some] @ L, nodes) / np.pi
        return value


def _hemisphere(axis: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return directions with density cos/pi about unit vectors (n, 3)."""
    radius, phi = np.sqrt(u), 2 * np.pi * v
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis), axis=1)])
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(axis, first)
    flat = (radius * np.cos(phi))[:, None] * first + (radius * np.sin(phi))[:, None] * second
    return flat + np.sqrt(1 - u)[:, None] * axis


def _both_sides(L: np.ndarray, a: np.ndarray, b: np.ndarray, nodes: int) -> np.ndarray:
    """Return int max(a . p, 0)/pi max(b . p, 0)/|L p| dp for a unit vector a and vectors b (n, 3).

    In the frame of a, with b in the plane of azimuth 0, p is positive to both where its elevation above that plane's poles is
    free and its angle in the plane is between the later beginning and the earlier end of two half circles.
    """
    y, weights = np.polynomial.legendre.leggauss(nodes)
    flat = b - (b @ a)[:, None] * a
    length = np.linalg.norm(flat, axis=1)
    spare = np.cross(a, np.eye(3)[np.argmin(np.abs(a))])
    x_axis = np.where(length[:, None] > 1e-12, flat, spare)
    x_axis = x_axis / np.linalg.norm(x_axis, axis=1)[:, None]
    y_axis = np.cross(a, x_axis)
    angle = np.arctan2(length, b @ a)  # of b from a, towards x
    centre, half = angle / 2, (np.pi - angle) / 2
    elevation, d_elevation = np.pi / 2 * y, np.pi / 2 * weights
    t = centre[:, None] + half[:, None] * y
    plane = np.cos(t)[..., None] * a + np.sin(t)[..., None] * x_axis[:, None]
    p = np.cos(elevation)[:, None] * plane[:, :, None] + np.sin(elevation)[:, None] * y_axis[:, None, None]
    seen = np.cos(t) * np.cos(t - angle[:, None]) * half[:, None] * weights
    stretched = np.sqrt(np.sum((p @ L.T) ** 2, axis=-1))
    total: np.ndarray = np.einsum("nk,nke,e->n", seen, 1 / stretched, np.cos(elevation) ** 3 * d_elevation)
    return total * np.linalg.norm(b, axis=1) / np.pi
