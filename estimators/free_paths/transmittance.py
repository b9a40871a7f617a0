"""Transmittance by free paths: does the path reach the surface?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.contracts import Draws
from fogproof.estimators.free_paths.extinction import Extinction
from fogproof.estimators.free_paths.free_path import FreePath, HomogeneousSpectralFreePath


@dataclass(frozen=True)
class AnalogTransmittance:
    """One free path a realisation: 1 if it reaches the surface at `length` [m], 0 if it collides; the mean is T.

    extinction  along the ray, see `extinction`; a number is a constant sigma_t [1/m]
    """

    extinction: Extinction | float
    length: float

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations, each at the cost of one sampled path."""
        paths = FreePath(self.extinction, self.length).distances(rng.random((n, 1)))
        return Draws((paths == self.length).astype(np.float64), cost=np.ones(n))


@dataclass(frozen=True)
class SpectralTransmittance:
    """One free path for all channels: T_i / P(length) for channel i if it reaches the surface, 0 if it collides.

    The second moment of channel i is T_i^2 / P, P the mean of all T.
    """

    sigma_t: tuple[float, ...]
    length: float

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, channels), each at the cost of one sampled path."""
        paths = HomogeneousSpectralFreePath(self.sigma_t, self.length).sample(rng.random((n, 2)))
        assert paths.weight is not None
        assert paths.event is not None
        return Draws(paths.weight * paths.event[:, None], cost=np.ones(n))
