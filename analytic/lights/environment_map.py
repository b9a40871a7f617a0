"""The environment as an image: pixel by pixel Gauss-Legendre in the cosine of the polar angle and in the azimuth.

Between the edges of the pixels the light is constant, so that the rules converge as those of what it is multiplied with. Dark
pixels have no nodes.
"""

from __future__ import annotations

import math

import numpy as np

from fogproof.analytic.airlight.incident import Incident
from fogproof.errors import UnsupportedError
from fogproof.scene.lights import EnvironmentMap

MOST_LIT = 2048
"""Pixels that are integrated over, dark ones not counted."""


def incident(light: EnvironmentMap, x: np.ndarray, nodes: int) -> Incident:
    """Return the same directions for all points: as many nodes from pole to pole as for other lights, twice as many around.

    Whatever the pixels, a rule with more nodes has more in each of them: what two rules differ by is the error.
    """
    rows, columns = light.image.shape
    lit_row, lit_column = np.nonzero(light.image if np.any(light.image) else light.image == 0)
    if len(lit_row) > MOST_LIT:
        what = f"the oracle integrates over at most {MOST_LIT} lit pixels, and this picture has {len(lit_row)}"
        raise UnsupportedError(f"{what}: take means over blocks of them", "light.image")
    fewest = math.ceil(nodes / 8) + 1
    edges = np.cos(np.pi * np.arange(rows + 1) / rows)
    y, dy = _rule(max(fewest, math.ceil(2 * nodes / rows)))
    z, dz = _rule(max(fewest, math.ceil(4 * nodes / columns)))
    high, low = edges[lit_row], edges[lit_row + 1]
    cosine = low[:, None] + (high - low)[:, None] * y
    phi = 2 * np.pi / columns * (lit_column[:, None] + z)
    sine = np.sqrt((1 - cosine) * (1 + cosine))
    flat = np.stack([np.cos(phi), np.sin(phi)], axis=-1)[:, None] * sine[:, :, None, None]
    up = np.broadcast_to(cosine[:, :, None, None], (*flat.shape[:3], 1))
    w = np.concatenate([flat, up], axis=-1).reshape(-1, 3)
    solid = light.image[lit_row, lit_column] * (high - low) * (2 * np.pi / columns)
    weight = (solid[:, None, None] * dy[:, None] * dz).ravel()
    shape = (len(x), len(weight))
    return Incident(np.broadcast_to(w, (*shape, 3)), np.full(shape, np.inf), np.broadcast_to(weight, shape))


def _rule(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes in (0, 1) and weights that sum to 1."""
    y, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (y + 1), 0.5 * weights
