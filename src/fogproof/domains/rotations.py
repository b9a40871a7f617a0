"""Rotations of space as unit quaternions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.domains.law import Law, squared
from fogproof.domains.sphere import TURN


@dataclass(frozen=True)
class Rotations:
    """Unit quaternions (n, 4); q and -q are one rotation. The measure is Haar's with total 1: uniform rotations have pdf 1.

    The uniform law is Shoemake's (1992). A pdf must be even: pdf(q) = pdf(-q).
    """

    shape = (4,)
    measure = 1.0

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which quaternions have length 1."""
        return np.abs(squared(x) - 1) <= 2 * slack

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law."""
        return Law(("length of the first pair", "first angle", "second angle"), _place, _coordinates, _ones)


def _place(u: np.ndarray) -> np.ndarray:
    first, second = TURN * u[:, 1], 0.5 * TURN * u[:, 2]
    r, s = np.sqrt(u[:, 0]), np.sqrt(1 - u[:, 0])
    return np.stack([r * np.cos(first), r * np.sin(first), s * np.cos(second), s * np.sin(second)], axis=-1)


def _coordinates(x: np.ndarray, v: np.ndarray) -> np.ndarray:
    below = (x[:, 3] < 0) | ((x[:, 3] == 0) & (x[:, 2] < 0))
    x = np.where(below[:, None], -x, x)
    first, second = np.arctan2(x[:, 1], x[:, 0]) / TURN, np.arctan2(x[:, 3], x[:, 2]) / (0.5 * TURN)
    first = np.where(first < 0, first + 1, first)
    return np.clip(np.stack([x[:, 0] ** 2 + x[:, 1] ** 2, first, second], axis=-1), 0.0, 1.0)


def _ones(x: np.ndarray) -> np.ndarray:
    return np.ones(len(x))
