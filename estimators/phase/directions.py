"""Scattered directions and scattering cosines of any phase function, as samplers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import Interval, UnitSphere
from fogproof.estimators.blocks import blocks
from fogproof.estimators.phase import functions as formulas
from fogproof.estimators.phase.frames import Axis, half_chord_square, turn
from fogproof.scene import PhaseFunction


@dataclass(frozen=True)
class Directions:
    """Directions scattered by `phase`, about the propagation direction `axis`; in the precision of the uniforms.

    The pdf is the phase function itself, but for a Lorenz-Mie function, which is sampled from a table: there `weight` is the
    phase function over that pdf.
    """

    phase: PhaseFunction
    axis: Axis = (0.0, 0.0, 1.0)
    domain: ClassVar[UnitSphere] = UnitSphere()
    dimensions: ClassVar[int] = 2

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 2) to directions (n, 3) and their pdf [1/sr]."""
        x, pdf = np.empty((len(u), 3), u.dtype), np.empty(len(u), u.dtype)
        sampled = formulas.phase_table(self.phase)
        weight = None if sampled == self.phase else np.empty(len(u), u.dtype)
        for block in blocks(len(u)):
            at = formulas.polar(sampled, np.ascontiguousarray(u[block, 0]))
            turn(self.axis, at.versine, at.coversine, u[block, 1], out=x[block])
            pdf[block] = at.pdf
            if weight is not None:
                weight[block] = formulas.density(self.phase, at.versine, at.coversine) / at.pdf
        return Draw(x, pdf, weight)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of directions x (n, 3) [1/sr]."""
        return self._at(formulas.phase_table(self.phase), x)

    def eval(self, x: np.ndarray) -> np.ndarray:
        """Return the phase function at directions x (n, 3) [1/sr]."""
        return self._at(self.phase, x)

    def _at(self, phase: PhaseFunction, x: np.ndarray) -> np.ndarray:
        """Return a density at x from the chords to both poles, 2 (1 - mu) = |x - axis|^2: near them mu itself loses digits."""
        value = np.empty(len(x))
        for block in blocks(len(x)):
            versine, coversine = half_chord_square(x[block], self.axis), half_chord_square(-x[block], self.axis)
            value[block] = formulas.density(phase, versine, coversine)
        return value


@dataclass(frozen=True)
class Cosines:
    """Forward cosines of `phase` alone, for those who turn no directions; in the precision of the uniforms."""

    phase: PhaseFunction
    domain: ClassVar[Interval] = Interval(-1.0, 1.0)
    dimensions: ClassVar[int] = 1

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to cosines (n,)."""
        mu = np.empty(len(u), u.dtype)
        for block in blocks(len(u)):
            formulas.cosines(self.phase, u[block, 0], mu[block])
        return Draw(mu)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of cosines x (n,)."""
        value = np.empty(len(x))
        phase = formulas.phase_table(self.phase)
        for block in blocks(len(x)):
            value[block] = 2 * np.pi * formulas.density(phase, 1 - x[block], 1 + x[block])
        return value
