"""Scores: derivatives of the logarithm of a density by its parameter."""

from __future__ import annotations

import numpy as np


def asymmetry_score(g: float, mu: np.ndarray) -> np.ndarray:
    """Return d ln f/d g of Henyey & Greenstein's f at forward cosines mu."""
    return 3 * (mu - g) / (1 + g * g - 2 * g * mu) - 2 * g / (1 - g * g)
