"""A phase function from its Legendre moments."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.phase.phase_function import PhaseFunction
from fogproof.validate import as_float_array, require

HIGHEST = 2000
"""Highest order of a series; a density takes time as its order."""

ROUNDING = 2.0**-46
"""Negative values smaller than this share of the sum of all terms are rounding of a zero."""


@dataclass(frozen=True)
class LegendreSeries(PhaseFunction):
    """f(mu) = sum_l (2 l + 1)/(4 pi) chi_l P_l(mu) with the moments chi_0 = 1, chi_1 (the mean cosine), …, chi_N.

    moments  chi_l in [-1, 1], without the factor 2 l + 1; `LegendreSeries.from_coefficients` takes them with it

    A series that is negative somewhere is refused: of a peaked function the first few moments are. It is looked for at 32
    angles an order, and around each minimum there.
    """

    moments: tuple[float, ...]

    def __post_init__(self) -> None:
        chi = as_float_array("moments", self.moments)
        if chi.ndim != 1 or not 1 <= chi.size <= HIGHEST + 1:
            raise InvalidValueError("moments", f"must be a list of 1 to {HIGHEST + 1} numbers", self.moments)
        factor = 2.0 * np.arange(chi.size) + 1
        fix = "" if np.any(np.abs(chi) > factor) else "with the factor 2 l + 1 use LegendreSeries.from_coefficients"
        require("moments", chi, np.abs(chi) <= 1, "must lie in [-1, 1]", fix)
        if chi[0] != 1:
            raise InvalidValueError("moments", "must begin with chi_0 = 1", chi[0], "divide all of them by the first")
        least, mu = _least(factor * chi)
        if least < -ROUNDING * float(factor @ np.abs(chi)):
            fix = "take more moments, or truncate by delta-M; if they hold the factor 2 l + 1, use from_coefficients"
            rule = f"must make a series that is nowhere negative (at mu = {mu:.6g} it is {least / (4 * np.pi):.3g}/sr)"
            raise InvalidValueError("moments", rule, self.moments, fix)
        object.__setattr__(self, "moments", tuple(chi.tolist()))

    @classmethod
    def from_coefficients(cls, coefficients: Any) -> LegendreSeries:
        """Return the function sum_l beta_l/(4 pi) P_l(mu): moments with the factor 2 l + 1 in them, beta_0 = 1."""
        beta = as_float_array("coefficients", coefficients)
        if beta.ndim != 1 or beta.size < 1:
            raise InvalidValueError("coefficients", "must be a list of numbers", coefficients)
        factor = 2.0 * np.arange(beta.size) + 1
        require("coefficients", beta, np.abs(beta) <= factor, "must lie in [-(2 l + 1), 2 l + 1]")
        return cls(tuple((beta / factor).tolist()))


def _least(beta: np.ndarray) -> tuple[float, float]:
    """Return the least value of sum_l beta_l P_l(mu) that is found, and its cosine."""

    def at(theta: np.ndarray) -> np.ndarray:
        value: np.ndarray = np.polynomial.legendre.legval(np.cos(theta), beta)
        return value

    step = np.pi / (32 * beta.size)
    theta = np.arange(32 * beta.size + 1) * step
    value = at(theta)
    left, right = np.append(np.inf, value[:-1]), np.append(value[1:], np.inf)
    around = theta[(value <= left) & (value <= right)]
    for _ in range(10):
        near = np.clip(around[:, None] + step * np.linspace(-1, 1, 9), 0, np.pi)
        around = near[np.arange(len(near)), np.argmin(at(near), axis=1)]
        step /= 4
    best = around[np.argmin(at(around))]
    return float(at(best)), float(np.cos(best))
