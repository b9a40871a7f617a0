"""Evenly spread points of the unit cube, differently placed from any grid.

Kronecker's sequence with the powers of the generalised golden ratio (Roberts 2018), turned by a random shift: whatever has a volume
of a few times 1 / n and is not thin holds one of n points.
"""

from __future__ import annotations

import numpy as np


def lattice(n: int, k: int, shift: np.ndarray) -> np.ndarray:
    """Return (n, k) points in [0, 1)^k, turned by `shift` (k,) in [0, 1)."""
    golden = 2.0
    for _ in range(64):
        golden = (1 + golden) ** (1 / (k + 1))
    steps = golden ** -np.arange(1.0, k + 1)
    return np.asarray((np.arange(1, n + 1)[:, None] * steps + shift) % 1.0)
