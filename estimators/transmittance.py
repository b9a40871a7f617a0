"""Transmittance by analog free paths: does the path reach the surface?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.contracts import Draws
from fogproof.estimators.free_path import HomogeneousFreePath


@dataclass(frozen=True)
class AnalogTransmittance:
    """One free path a realisation: 1 if it reaches the surface at `length` [m], 0 if it collides; the mean is T."""

    sigma_t: float
    length: float

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations, each at the cost of one sampled path."""
        paths = HomogeneousFreePath(self.sigma_t, self.length).sample(rng.random((n, 1)))
        assert paths.event is not None
        return Draws(paths.event.astype(np.float64), cost=np.ones(n))
