"""Phase functions: density, distribution, its inverse and mean cosine, for every kind the scene description knows.

Convention: mu = (propagation direction in) . (propagation direction out), so mu = 1 goes straight on and g > 0, the
mean of mu, scatters forward. Densities are per steradian, normalised to 2 pi int_-1^1 f(mu) dmu = 1 for every kind:
what a parametrisation leaves over (a table, weights, a Lorenz-Mie series) is divided out, and its error counted.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from types import ModuleType
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.declaration import FORWARD, quantity
from fogproof.analytic.phase import draine as phase_draine
from fogproof.analytic.phase import henyey_greenstein as phase_henyey_greenstein
from fogproof.analytic.phase import isotropic as phase_isotropic
from fogproof.analytic.phase import lobes as phase_lobes
from fogproof.analytic.phase import mie as phase_mie
from fogproof.analytic.phase import rayleigh as phase_rayleigh
from fogproof.analytic.phase import schlick as phase_schlick
from fogproof.analytic.phase import tabulated as phase_tabulated
from fogproof.analytic.phase.inverse import inverse_cdf
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError
from fogproof.scene import phase_functions as scene
from fogproof.scene.arrays import FloatArray
from fogproof.scene.phase_functions import PhaseFunction, PhaseFunctionField
from fogproof.validate import as_float_array, require

Parts = list[tuple[Fraction, PhaseFunction]]

BLOCK = 8192
"""Elements evaluated at a time: the temporaries of a Lorenz-Mie series of them stay in the cache."""

COSINE_SLOP = 8 * EPS
"""How far beyond [-1, 1] a cosine may lie: a dot product of two unit vectors rounds to as much as 1 + 2 eps or so."""

FORMULAS: dict[type, ModuleType] = {
    scene.Isotropic: phase_isotropic,
    scene.HenyeyGreenstein: phase_henyey_greenstein,
    scene.Schlick: phase_schlick,
    scene.Hazy: phase_lobes,
    scene.Murky: phase_lobes,
    scene.Rayleigh: phase_rayleigh,
    scene.CornetteShanks: phase_draine,
    scene.Draine: phase_draine,
    scene.Mie: phase_mie,
    scene.Tabulated: phase_tabulated,
}
"""The module with the formulas of each simple kind; the others are weighted means of these.

Each has SOURCE, METHOD, `pdf(phase, mu)`, `cdf(phase, mu)` and `mean_cosine(phase)`, and, where there
is a closed form, `quantile(phase, xi)`; all return (value, error).
"""


@quantity(
    unit="1/sr",
    convention=FORWARD,
    source="van de Hulst 1957, Light Scattering by Small Particles; each kind has its own",
    example={"phase": {"kind": "henyey-greenstein", "g": 0.6}, "mu": [-1, -0.5, 0, 0.5, 0.9, 1]},
)
def phase_pdf(phase: PhaseFunctionField, mu: FloatArray) -> Reference:
    """Return the phase function f_p(mu) [1/sr].

    phase  a phase function of the scene description
    mu     (...) forward cosines in [-1, 1]; a value less than 8 eps = 1.8e-15 beyond an end is taken as that end

    The result has the shape of mu. Closed forms have a relative error of a few eps for every parameter allowed.
    """
    parts = weighted_parts(phase)
    return _reference(parts, _method(parts), *_in_blocks(lambda x: _sum(parts, "pdf", x), _cosines(mu)))


@quantity(
    unit="1",
    convention="probability that the cosine is <= mu; " + FORWARD,
    source="van de Hulst 1957, Light Scattering by Small Particles; each kind has its own",
    example={"phase": {"kind": "henyey-greenstein", "g": 0.6}, "mu": [-1, -0.5, 0, 0.5, 0.9, 1]},
)
def phase_cdf(phase: PhaseFunctionField, mu: FloatArray) -> Reference:
    """Return the probability that the forward cosine is at most mu: 2 pi int_-1^mu f_p(m) dm.

    phase  a phase function of the scene description
    mu     (...) forward cosines in [-1, 1]; a value less than 8 eps = 1.8e-15 beyond an end is taken as that end

    The result has the shape of mu. Closed forms have a relative error of a few eps, also in the lower tail; Lorenz-Mie
    has an absolute one.
    """
    parts = weighted_parts(phase)
    return _reference(parts, _method(parts), *_in_blocks(lambda x: _sum(parts, "cdf", x), _cosines(mu)))


@quantity(
    unit="1",
    convention="the cosine below which a share xi is scattered; " + FORWARD,
    source="van de Hulst 1957, Light Scattering by Small Particles; each kind has its own",
    example={"phase": {"kind": "henyey-greenstein", "g": 0.6}, "xi": [0, 0.1, 0.5, 0.9, 1]},
)
def phase_quantile(phase: PhaseFunctionField, xi: FloatArray) -> Reference:
    """Return the smallest forward cosine mu with phase_cdf(phase, mu) >= xi.

    phase  a phase function of the scene description
    xi     (...) probabilities in [0, 1]

    The result has the shape of xi; its error is absolute, at best a few eps. Where there is no closed form it comes
    from a root finder, and the error from an interval at whose ends the distribution lies on either side of xi.
    """
    xi = as_float_array("xi", xi)
    require("xi", xi, (xi >= 0) & (xi <= 1), "must be a probability in [0, 1]")
    parts = weighted_parts(phase)
    formulas = FORMULAS[type(parts[0][1])]
    if len(parts) == 1 and hasattr(formulas, "quantile"):
        simple = parts[0][1]
        return _reference(parts, "closed form", *_in_blocks(lambda x: formulas.quantile(simple, x), xi))
    value, error = _in_blocks(lambda x: inverse_cdf(lambda mu: _sum(parts, "cdf", mu), x), xi)
    return _reference(parts, f"root of the cdf ({_method(parts)})", value, error)


@quantity(
    unit="1",
    convention="g, the mean of mu; " + FORWARD,
    source="van de Hulst 1957, Light Scattering by Small Particles; each kind has its own",
    example={"phase": {"kind": "cornette-shanks", "g": 0.7}},
)
def phase_mean_cosine(phase: PhaseFunctionField) -> Reference:
    """Return g = 2 pi int_-1^1 f_p(mu) mu dmu, the mean forward cosine, of shape ().

    phase  a phase function of the scene description
    """
    parts = weighted_parts(phase)
    return _reference(parts, _method(parts), *_sum(parts, "mean_cosine"))


def weighted_parts(phase: PhaseFunction) -> Parts:
    """Return a phase function as (weight, simple phase function) pairs; the weights are exact, positive, and sum to 1."""
    match phase:
        case scene.DoubleHenyeyGreenstein(g1, g2, weight):
            w = Fraction(weight)
            parts: Parts = [(w, scene.HenyeyGreenstein(g1)), (1 - w, scene.HenyeyGreenstein(g2))]
        case scene.Mixture(components, weights):
            total = sum(map(Fraction, weights))
            parts = [
                (Fraction(outer) / total * inner, part)
                for outer, component in zip(weights, components, strict=True)
                for inner, part in weighted_parts(component)
            ]
        case _ if type(phase) in FORMULAS:
            return [(Fraction(1), phase)]
        case _:
            known = ", ".join(kind.__name__ for kind in scene.PHASE_FUNCTIONS.values())
            raise InvalidValueError("phase", "must be a phase function", phase, f"one of {known}")
    return [(weight, part) for weight, part in parts if weight]


def _sum(parts: Parts, what: str, *mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the weighted mean of one of the formulas, and its error."""
    pairs = [getattr(FORMULAS[type(part)], what)(part, *mu) for _, part in parts]
    if len(parts) == 1:
        return pairs[0]
    weights = [float(weight) for weight, _ in parts]
    value = sum(w * v for w, (v, _) in zip(weights, pairs, strict=True))
    size = sum(w * (e + (len(parts) + 2) / 2 * EPS * abs(v)) for w, (v, e) in zip(weights, pairs, strict=True))
    return value, size


def _cosines(mu: Any) -> np.ndarray:
    mu = as_float_array("mu", mu)
    fix = "mu is the dot product of two unit vectors: normalise them"
    require("mu", mu, np.abs(mu) <= 1 + COSINE_SLOP, "must be a cosine in [-1, 1]", fix)
    return np.clip(mu, -1, 1)


def _in_blocks(
    formula: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], x: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    value, error = np.empty((2, x.size))
    flat = x.ravel()
    for start in range(0, flat.size, BLOCK):
        block = slice(start, start + BLOCK)
        value[block], error[block] = formula(flat[block])
    return value.reshape(x.shape), error.reshape(x.shape)


def _reference(parts: Parts, method: str, value: Any, error: Any) -> Reference:
    source = "; ".join(dict.fromkeys(FORMULAS[type(part)].SOURCE for _, part in parts))
    return Reference(np.asarray(value), np.asarray(error), method, source)


def _method(parts: Parts) -> str:
    return ", ".join(dict.fromkeys(FORMULAS[type(part)].METHOD for _, part in parts))
