"""The unit disk."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.domains.law import Law, at_the_ends, squared
from fogproof.domains.sphere import TURN, azimuth


@dataclass(frozen=True)
class UnitDisk:
    """The disk x^2 + y^2 <= 1; the pdf is per unit area."""

    shape = (2,)
    measure = 0.5 * TURN

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which points have a radius of 1 at most."""
        return squared(x) <= 1 + 2 * at_the_ends(slack)

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law."""
        return Law(("r^2", "phi"), _place, _coordinates, lambda x: np.full(len(x), 1 / self.measure))


def _place(u: np.ndarray) -> np.ndarray:
    r, phi = np.sqrt(u[:, 0]), TURN * (u[:, 1] - 0.5)
    return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=-1)


def _coordinates(x: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.stack([np.minimum(squared(x), 1.0), azimuth(x[:, 0], x[:, 1])], axis=-1)
