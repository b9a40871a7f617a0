"""Ways against a disk."""

from __future__ import annotations

import numpy as np

from fogproof.scene.occluders import Disk


def meets(disk: Disk, x: np.ndarray, w: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """The way crosses the plane inside the disk; one in the plane itself does not."""
    normal = np.asarray(disk.normal)
    centre = np.asarray(disk.center)[:, None] - x
    height, slope = normal @ centre, normal @ w
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        crossing = height / slope
    crosses = (crossing > 0) & (crossing < distance)
    gap = np.where(crosses, crossing, 0.0) * w - centre
    return crosses & (np.sum(gap * gap, axis=0) < disk.radius**2)
