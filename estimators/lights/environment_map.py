"""The environment as an image: a pixel by its power, a direction uniform in it (Pharr, Jakob & Humphreys 2016, section 14.2.4)."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.airlight.lighting import Sampled
from fogproof.estimators.grey import grey
from fogproof.scene.lights import EnvironmentMap


def sample(light: EnvironmentMap, x: np.ndarray, u: np.ndarray) -> Sampled:
    """Return directions with a density proportional to the image, the same for all points x (3, n), from uniforms u (n, 2)."""
    rows, columns = light.image.shape
    top = np.cos(np.pi * np.arange(rows) / rows)
    height = 2 * np.sin(np.pi / (2 * rows)) * np.sin(np.pi * (np.arange(rows) + 0.5) / rows)  # cos - cos of both edges
    power = light.image * (height * 2 * np.pi / columns)[:, None]
    in_row = power.sum(axis=1)
    total = float(in_row.sum())
    if total == 0:
        return Sampled(np.tile([[0.0], [0.0], [1.0]], len(u)), np.full(len(u), np.inf), np.zeros(len(u)))
    row, down = _chosen(np.cumsum(in_row), u[:, 0] * total)
    column, across = np.empty(len(u), int), np.empty(len(u))
    for r in np.unique(row):
        some = row == r
        column[some], across[some] = _chosen(np.cumsum(power[r]), u[some, 1] * in_row[r])
    cosine = np.clip(top[row] - down * height[row], -1, 1)
    phi, sine = 2 * np.pi * (column + across) / columns, np.sqrt((1 - cosine) * (1 + cosine))
    w = np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine])
    return Sampled(w, np.full(len(u), np.inf), np.full(len(u), grey("radiance", light.radiance) * total))


def _chosen(upto: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the cells of a cumulative sum that targets fall into, and where in them, in [0, 1); cells of no size are never met."""
    cell = np.minimum(np.searchsorted(upto, target, side="right"), np.searchsorted(upto, upto[-1]))
    before = np.where(cell > 0, upto[cell - 1], 0.0)
    return cell, np.clip((target - before) / (upto[cell] - before), 0.0, 1 - 2.0**-53)
