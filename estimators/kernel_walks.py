"""Random walks in an infinite homogeneous medium. Lengths are in mean free paths."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernel_path_data import Lobe
from fogproof.estimators.kernel_scattering import scattered, uniform_direction
from fogproof.estimators.kernels import kernel


@kernel
def displacements(rng: np.random.Generator, lobe: Lobe, flights: int, moved: np.ndarray) -> None:
    """Write where walks that begin along +z are after a number of flights into moved (n, 3)."""
    for i in range(len(moved)):
        x, y, z = 0.0, 0.0, 0.0
        dx, dy, dz = 0.0, 0.0, 1.0
        for k in range(flights):
            if k > 0:
                dx, dy, dz = scattered(rng, lobe, dx, dy, dz)
            t = rng.standard_exponential()
            x, y, z = x + t * dx, y + t * dy, z + t * dz
        moved[i, 0], moved[i, 1], moved[i, 2] = x, y, z


@kernel
def collisions_within(
    rng: np.random.Generator, lobe: Lobe, albedo: float, radii: np.ndarray, count: np.ndarray
) -> None:
    """Count the collisions of walks from the origin within balls about it; each collision ends one with 1 - albedo.

    radii  (balls,); count (n, balls)
    """
    for i in range(len(count)):
        for k in range(len(radii)):
            count[i, k] = 0.0
        x, y, z = 0.0, 0.0, 0.0
        dx, dy, dz = uniform_direction(rng)
        while True:
            t = rng.standard_exponential()
            x, y, z = x + t * dx, y + t * dy, z + t * dz
            r = np.sqrt(x * x + y * y + z * z)
            for k in range(len(radii)):
                if r <= radii[k]:
                    count[i, k] += 1.0
            if rng.random() >= albedo:
                break
            dx, dy, dz = scattered(rng, lobe, dx, dy, dz)
