"""Phase functions: density and distribution of the forward cosine, for every kind the scene description knows.

Convention: mu = (propagation direction in) . (propagation direction out), so mu = 1 goes straight on and g > 0, the
mean of mu, scatters forward. Densities are per steradian, normalised to 2 pi int_-1^1 f(mu) dmu = 1.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import phase_henyey_greenstein, phase_isotropic, phase_rayleigh
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError
from fogproof.scene import phase_functions as scene
from fogproof.scene.phase_functions import PhaseFunction
from fogproof.validate import as_float_array, require

BLOCK = 65536
"""Elements evaluated at a time: larger temporaries fall out of the cache."""

COSINE_SLOP = 8 * np.finfo(np.float64).eps
"""How far beyond [-1, 1] a cosine may lie: a dot product of two unit vectors rounds to as much as 1 + 2 eps or so."""

FORMULAS: dict[type, Any] = {
    scene.Isotropic: phase_isotropic,
    scene.HenyeyGreenstein: phase_henyey_greenstein,
    scene.Rayleigh: phase_rayleigh,
}
"""The module with the formulas of each kind: functions `(phase, array) -> (value, error)`, and its SOURCE."""


def phase_pdf(phase: PhaseFunction, mu: Any) -> Reference:
    """Return the phase function f_p(mu) [1/sr].

    phase  a phase function of the scene description
    mu     (...) forward cosines in [-1, 1]; a value less than 8 eps = 1.8e-15 beyond an end is taken as that end

    The result has the shape of mu. Closed forms have a relative error of a few eps for every parameter allowed; the
    bound is in `error`.
    """
    formulas = _formulas(phase)
    return _evaluate(formulas.pdf, phase, _cosines(mu), "closed form", formulas.SOURCE)


def phase_cdf(phase: PhaseFunction, mu: Any) -> Reference:
    """Return the probability that the forward cosine is at most mu: 2 pi int_-1^mu f_p(m) dm.

    phase  a phase function of the scene description
    mu     (...) forward cosines in [-1, 1]; a value less than 8 eps = 1.8e-15 beyond an end is taken as that end

    The result has the shape of mu. The relative error is a few eps also in the lower tail; the bound is in `error`.
    """
    formulas = _formulas(phase)
    return _evaluate(formulas.cdf, phase, _cosines(mu), "closed form", formulas.SOURCE)


def _formulas(phase: PhaseFunction) -> Any:
    if type(phase) not in FORMULAS:
        known = ", ".join(kind.__name__ for kind in FORMULAS)
        raise InvalidValueError("phase", "must be a phase function", phase, f"one of {known}")
    return FORMULAS[type(phase)]


def _cosines(mu: Any) -> np.ndarray:
    mu = as_float_array("mu", mu)
    fix = "mu is the dot product of two unit vectors: normalise them"
    require("mu", mu, np.abs(mu) <= 1 + COSINE_SLOP, "must be a cosine in [-1, 1]", fix)
    return np.clip(mu, -1, 1)


def _evaluate(
    formula: Callable[..., tuple[np.ndarray, np.ndarray]], phase: PhaseFunction, x: np.ndarray, method: str, source: str
) -> Reference:
    value, error = np.empty((2, x.size))
    flat = x.ravel()
    for start in range(0, flat.size, BLOCK):
        block = slice(start, start + BLOCK)
        value[block], error[block] = formula(phase, flat[block])
    return Reference(value.reshape(x.shape), error.reshape(x.shape), method, source)
