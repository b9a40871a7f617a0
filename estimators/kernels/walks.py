"""Random walks in an infinite homogeneous medium. Lengths are in mean free paths."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.estimators.kernels.compiling import kernel
from fogproof.estimators.kernels.scattering import scattered, uniform_direction


@kernel
def displacements(rng: np.random.Generator, lobe: Any, flights: int, moved: np.ndarray) -> None:
    """Write where walks that begin along +z are after a number of flights into moved (n, 3)."""
    for i in range(len(moved)):
        x, y, z = 0.0, 0.0, 0.0
        dx, dy, dz = 0.0, 0.0, 1.0
        for k in range(flights):
            if k > 0:
                dx, dy, dz = scattered(rng, lobe, x, y, z, dx, dy, dz)
            t = rng.standard_exponential()
            x, y, z = x + t * dx, y + t * dy, z + t * dz
        moved[i, 0], moved[i, 1], moved[i, 2] = x, y, z


@kernel
def collisions_within(rng: np.random.Generator, lobe: Any, albedo: float, radii: np.ndarray, count: np.ndarray) -> None:
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
            dx, dy, dz = scattered(rng, lobe, x, y, z, dx, dy, dz)


@kernel
def along_rod(
    rng: np.random.Generator, albedo: float, length: float, forward: float, left: np.ndarray, collisions: np.ndarray
) -> None:
    """Write by which end walks leave that enter a rod at 0: left (n, 2) one of (1, 0) back, (0, 1) beyond, (0, 0) absorbed.

    forward     probability of going on in the same direction after scattering
    collisions  (n,)
    """
    for i in range(len(left)):
        x, sign, count = 0.0, 1.0, 0
        left[i, 0] = left[i, 1] = 0.0
        while True:
            x += sign * rng.standard_exponential()
            if x < 0.0:
                left[i, 0] = 1.0
                break
            if x > length:
                left[i, 1] = 1.0
                break
            count += 1
            if rng.random() >= albedo:
                break
            if rng.random() >= forward:
                sign = -sign
        collisions[i] = count
