"""Rays in a row, as the oracle's loops over blocks take them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from fogproof.scene import Ray

BLOCK = 8192
"""Rays at a time: their temporaries stay in the cache."""


class FlatRays(NamedTuple):
    """Rays that have been checked: origin and unit direction (n, 3), length (n,)."""

    origin: np.ndarray
    direction: np.ndarray
    length: np.ndarray


def blocks_of(ray: Ray) -> Iterator[FlatRays]:
    """Yield the rays in blocks, at least one."""
    flat = ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3), ray.length.ravel()
    for i in range(0, max(flat[2].size, 1), BLOCK):
        yield FlatRays(*(x[i : i + BLOCK] for x in flat))
