"""Phase functions as the airlight integral sees them: 4 pi f_p at the cosine (wt - w) / (wt + w).

At a point t of the ray, w = r + t and wt = r - t are positive and known without cancellation, so each formula is
written in them: 1 - mu = 2 w / (w + wt) and 1 + mu = 2 wt / (w + wt) keep their relative accuracy to the very ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.phase.kinds import formula, weighted_parts
from fogproof.scene.phase import PhaseFunction

Array = np.ndarray
Slope = Callable[[Array, Array], tuple[Array, Array]]


class AirlightPhase(NamedTuple):
    """What the integral needs to know about F = 4 pi f_p.

    factor    (w, wt) -> F, or None where it is 1; (F, its absolute error) if `noisy`
    floor     lower bound of F
    peak      upper bound of F, inf if it has none
    eps       relative rounding error of F, in units of 2^-52
    slope     (mu_low, mu_high) -> bounds (of |d log F / d theta|, and of |dF / d theta| beyond that), over these cosines:
              what an error of the angle costs
    absolute  absolute rounding error of F, in units of 2^-52, besides the relative one
    degree    how many factors tanh s the formula multiplies, which panels must resolve
    kinks     cosines where F is not smooth
    noisy     whether `factor` returns its error
    folds     the `spread` of an unbounded F, where 1 - mu is at least 1e-300
    finer     kinks and more, where it is not known that F is smooth between them: the error is what they change
    """

    factor: Callable[[Array, Array], Any] | None
    floor: float
    peak: float
    eps: float
    slope: Slope
    absolute: float = 0.0
    degree: int = 0
    kinks: Array = np.empty(0)
    noisy: bool = False
    finer: Array = np.empty(0)
    folds: float = 0.0

    @property
    def spread(self) -> float:
        """How many e-folds further than without F the tails of the integral can matter; inf if F reaches 0."""
        if self.peak == math.inf:
            return self.folds
        return math.log(self.peak / self.floor) if self.floor > 0 else math.inf


def airlight_phase(phase: PhaseFunction) -> AirlightPhase:
    """Return the form of `phase` that the airlight integral uses."""
    parts = weighted_parts(phase)
    forms = [(float(weight), formula(part, "airlight")(part)) for weight, part in parts]
    return forms[0][1] if len(forms) == 1 else _mixture(forms)


def no_slope(low: Array, _high: Array) -> tuple[Array, Array]:
    """Return the slope of a constant."""
    return np.zeros_like(low), np.zeros_like(low)


def _mixture(weighted: list[tuple[float, AirlightPhase]]) -> AirlightPhase:
    """Build the weighted mean of the parts."""
    noisy = any(part.noisy for _, part in weighted)

    def factor(w: Array, wt: Array) -> Any:
        total, noise = np.zeros_like(w), np.zeros_like(w)
        for weight, part in weighted:
            own = np.ones_like(w) if part.factor is None else part.factor(w, wt)
            if part.noisy:
                own, own_noise = own
                noise += weight * own_noise
            total += weight * own
        return (total, noise) if noisy else total

    def slope(low: Array, high: Array) -> tuple[Array, Array]:
        slopes = [(weight, *part.slope(low, high)) for weight, part in weighted]
        return np.max([s for _, s, _ in slopes], axis=0), sum((w * s for w, _, s in slopes), np.zeros_like(low))

    return AirlightPhase(
        factor,
        sum(weight * part.floor for weight, part in weighted),
        sum(weight * part.peak for weight, part in weighted),
        max(part.eps for _, part in weighted) + len(weighted) + 2,
        slope,
        sum(weight * part.absolute for weight, part in weighted),
        max(part.degree for _, part in weighted),
        np.unique(np.concatenate([part.kinks for _, part in weighted])),
        noisy,
        np.unique(np.concatenate([part.finer for _, part in weighted])),
        max(part.folds for _, part in weighted),
    )
