"""The built-in noise medium: Perlin's improved noise (Perlin 2002, "Improving Noise") over octaves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene import Procedural
from fogproof.validate import number

HIGHEST = 1.0364
"""Above the greatest value of |noise|, 1.03635: all eight gradients pointing at one place near a cell's centre."""

_CUBE = "++0 -+0 +-0 --0 +0+ -0+ +0- -0- 0++ 0-+ 0+- 0-- ++0 0-+ -+0 0--"
_EDGES = np.array([["-0+".index(sign) - 1.0 for sign in edge] for edge in _CUBE.split()])
"""From the centre of a cube to its twelve edges, four of them twice."""


@dataclass(frozen=True)
class FractalNoise:
    """Extinction sigma_t(x) = density (1/2 + f(x)/2), f the octaves' weighted mean over its bound: in [0, density] everywhere.

    density    greatest possible extinction, hence the majorant [1/m]; the mean is half of it
    frequency  cells a metre of the coarsest octave [1/m]; each octave doubles it
    octaves    how many are summed
    gain       weight of each octave relative to the one before
    seed       of the table of gradients

    It is an array function of points (..., 3), and trackers know how to compile it.
    """

    density: float
    frequency: float
    octaves: int = 4
    gain: float = 0.5
    seed: int = 0

    def __post_init__(self) -> None:
        number("density", self.density, "must be finite and > 0 [1/m]", 0, open_ends=True)
        number("frequency", self.frequency, "must be finite and > 0 [1/m]", 0, open_ends=True)
        number("gain", self.gain, "must be finite and > 0", 0, open_ends=True)
        for name, least in (("octaves", 1), ("seed", 0)):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or value < least:
                raise InvalidValueError(name, f"must be a whole number >= {least}", value)

    @property
    def detail(self) -> float:
        """The smallest length over which the noise changes [m]: half a cell of the finest octave."""
        return 0.5 / (self.frequency * 2.0 ** (self.octaves - 1))

    @cached_property
    def table(self) -> np.ndarray:
        """A permutation of 0 … 255, twice in a row."""
        return np.tile(np.random.default_rng(self.seed).permutation(256), 2)

    def medium(self, **more: Any) -> Procedural:
        """Return a medium of this extinction; `more` are further fields of `Procedural`."""
        return Procedural(self, self.density, detail=self.detail, **more)

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Return sigma_t [1/m] at points (..., 3)."""
        weights = self.gain ** np.arange(self.octaves)
        scales = self.frequency * 2.0 ** np.arange(self.octaves)
        total = sum(weight * self._noise(x * scale) for weight, scale in zip(weights, scales, strict=True))
        return self.density * (0.5 + 0.5 * total / (HIGHEST * weights.sum()))

    def _noise(self, x: np.ndarray) -> np.ndarray:
        cell = np.floor(x)
        offset = x - cell
        corner = cell.astype(np.int64) & 255
        fade = offset**3 * (offset * (offset * 6 - 15) + 10)
        total = np.zeros(x.shape[:-1])
        for bits in product((0, 1), repeat=3):
            i, j, k = np.moveaxis(corner + bits, -1, 0)
            code = self.table[self.table[self.table[i] + j] + k]
            slope = np.sum(_EDGES[code & 15] * (offset - bits), axis=-1)
            total += slope * np.prod(np.where(bits, fade, 1 - fade), axis=-1)
        return total
