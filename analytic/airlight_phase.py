"""Phase functions as the airlight integral sees them: 4 pi f_p at the cosine (wt - w) / (wt + w).

At a point t of the ray, w = r + t and wt = r - t are positive and known without cancellation, so each formula is
written in them: 1 - mu = 2 w / (w + wt) and 1 + mu = 2 wt / (w + wt) keep their relative accuracy to the very ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.scene.phase_functions import HenyeyGreenstein, Isotropic, PhaseFunction, Rayleigh

Factor = Callable[[np.ndarray, np.ndarray], np.ndarray]
Slope = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class AirlightPhase:
    """What the integral needs to know about a phase function.

    factor  (w, wt) -> 4 pi f_p, or None where it is 1
    spread  log(max f_p / min f_p) over all directions, or a bound of it: how much further the tails can matter
    eps     relative rounding error of `factor`, in units of 2^-52
    slope   (mu_low, mu_high) -> bound of |d log f_p / d theta| over these cosines: what an error of the angle costs
    """

    factor: Factor | None
    spread: float
    eps: float
    slope: Slope


def airlight_phase(phase: PhaseFunction) -> AirlightPhase:
    """Return the form of `phase` that the airlight integral uses."""
    build = _BUILD.get(type(phase))
    if build is None:
        known = ", ".join(kind.__name__ for kind in _BUILD)
        raise UnsupportedError(f"no airlight integral for the phase function {phase!r}; known are {known}", "phase")
    return build(phase)


def _isotropic(_phase: Isotropic) -> AirlightPhase:
    return AirlightPhase(None, 0.0, 0.0, lambda low, high: np.zeros_like(low))


def _henyey_greenstein(phase: HenyeyGreenstein) -> AirlightPhase:
    """Build (1 - g^2) / (1 + g^2 - 2 g mu)^(3/2), where 1 + g^2 - 2 g mu = ((1-g)^2 wt + (1+g)^2 w) / (w + wt)."""
    g = phase.g
    backward, forward, scale = (1 + g) ** 2, (1 - g) ** 2, (1 - g) * (1 + g)

    def factor(w: np.ndarray, wt: np.ndarray) -> np.ndarray:
        ratio = (w + wt) / (backward * w + forward * wt)
        return ratio * np.sqrt(ratio) * scale

    def slope(low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """f_p is D^-3, D the distance of the direction from the point g of the axis: a turn moves it by |g| at most."""
        nearest = (1 - abs(g)) ** 2 + 2 * abs(g) * (1 - (high if g >= 0 else -low))
        return 3 * abs(g) / np.sqrt(nearest)

    return AirlightPhase(factor, 3 * abs(math.log1p(g) - math.log1p(-g)), 8.0, slope)


def _rayleigh(_phase: Rayleigh) -> AirlightPhase:
    """Build 3/4 (1 + mu^2)."""

    def factor(w: np.ndarray, wt: np.ndarray) -> np.ndarray:
        mu = (wt - w) / (wt + w)
        return 0.75 + 0.75 * (mu * mu)

    return AirlightPhase(factor, math.log(2), 4.0, lambda low, high: np.ones_like(low))


_BUILD: dict[type, Callable[[Any], AirlightPhase]] = {
    Isotropic: _isotropic,
    HenyeyGreenstein: _henyey_greenstein,
    Rayleigh: _rayleigh,
}
