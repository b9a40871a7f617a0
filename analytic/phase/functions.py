"""Phase functions: density, distribution, its inverse and mean cosine, for every kind the scene description knows.

Convention: mu = (propagation direction in) . (propagation direction out), so mu = 1 goes straight on and g > 0, the
mean of mu, scatters forward. Densities are per steradian, normalised to 2 pi int_-1^1 f(mu) dmu = 1 for every kind:
what a parametrisation leaves over (a table, weights, a Lorenz-Mie series) is divided out, and its error counted.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.blocks import in_blocks
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.declaration import FORWARD, quantity
from fogproof.analytic.phase.inverse import inverse_cdf
from fogproof.analytic.phase.kinds import ROOM, Parts, formula, weighted_parts
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import Count, FloatArray
from fogproof.scene.kinds import given, module_of
from fogproof.scene.phase import PhaseFunction, PhaseFunctionField
from fogproof.validate import as_float_array, require

HIGHEST = 10**6
"""Highest order of a Legendre moment that is answered."""

BLOCK = 8192
"""Elements evaluated at a time: the temporaries of a Lorenz-Mie series of them stay in the cache."""

COSINE_SLOP = 8 * EPS
"""How far beyond [-1, 1] a cosine may lie: a dot product of two unit vectors rounds to as much as 1 + 2 eps or so."""


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
    return _reference(parts, _method(parts, "pdf"), *in_blocks(lambda x: _sum(parts, "pdf", x), BLOCK, _cosines(mu)))


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
    return _reference(parts, _method(parts, "cdf"), *in_blocks(lambda x: _sum(parts, "cdf", x), BLOCK, _cosines(mu)))


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
    simple = parts[0][1]
    quantile = given(simple, ROOM, "quantile")
    if len(parts) == 1 and quantile is not None:
        return _reference(parts, "closed form", *in_blocks(lambda x: quantile(simple, x), BLOCK, xi))
    value, error = in_blocks(lambda x: inverse_cdf(lambda mu: _sum(parts, "cdf", mu), x), BLOCK, xi)
    return _reference(parts, f"root of the cdf ({_method(parts, 'cdf')})", value, error)


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
    return _reference(parts, _method(parts, "mean_cosine"), *_sum(parts, "mean_cosine"))


@quantity(
    unit="1",
    convention="chi_l, l = 0 … count, in the last axis: f_p = sum_l (2 l + 1)/(4 pi) chi_l P_l(mu); " + FORWARD,
    source="Chandrasekhar 1960, Radiative Transfer, section 48; each kind has its own",
    example={"phase": {"kind": "henyey-greenstein", "g": 0.6}, "count": 3},
)
def phase_legendre_moments(phase: PhaseFunctionField, count: Count) -> Reference:
    """Return chi_l = 2 pi int_-1^1 f_p(mu) P_l(mu) dmu for l = 0 … count, of shape (count + 1,).

    phase  a phase function of the scene description
    count  the highest order l, a whole number in [0, 10^6]

    chi_0 is 1, chi_1 the mean cosine, and f_p = sum_l (2 l + 1)/(4 pi) chi_l P_l(mu). Closed forms and tables have errors of
    a few l eps; elsewhere the error is estimated, and what the nodes of the quadrature miss of the integral of f_p counts.
    """
    if isinstance(count, bool) or not isinstance(count, int | np.integer) or not 0 <= count <= HIGHEST:
        raise InvalidValueError("count", f"must be a whole number in [0, {HIGHEST}]", count)
    parts = weighted_parts(phase)
    value, error = (np.array(x) for x in _sum(parts, "legendre_moments", int(count)))
    value[0], error[0] = 1.0, 0.0
    return _reference(parts, _method(parts, "legendre_moments"), value, error)


def has_poles(phase: PhaseFunction) -> bool:
    """Return whether a phase function may be infinite straight ahead or back: then it has a formula in (1 - mu)/2."""
    return any(given(part, ROOM, "density") is not None for _, part in weighted_parts(phase))


def phase_values(phase: PhaseFunction, mu: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f_p(mu) [1/sr], and its error, where (1 - mu)/2 = x and (1 + mu)/2 = y are known better than mu.

    Only kinds with a formula in x and y can make use of that; what they are rounded by does not count in the error.
    """
    parts = weighted_parts(phase)
    found = [
        part_of(part, x, y) if (part_of := given(part, ROOM, "density")) else formula(part, "pdf")(part, mu)
        for _, part in parts
    ]
    return _mean(parts, found)


def _sum(parts: Parts, what: str, *arguments: Any) -> tuple[Any, Any]:
    """Return the weighted mean of one of the formulas, and its error."""
    return _mean(parts, [formula(part, what)(part, *arguments) for _, part in parts])


def _mean(parts: Parts, pairs: list[tuple[Any, Any]]) -> tuple[Any, Any]:
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


def _reference(parts: Parts, method: str, value: Any, error: Any) -> Reference:
    source = "; ".join(dict.fromkeys(_words(part, "SOURCE") for _, part in parts))
    return Reference(np.asarray(value), np.asarray(error), method, source)


def _method(parts: Parts, what: str) -> str:
    return ", ".join(
        dict.fromkeys(
            "quadrature of the pdf" if given(part, ROOM, what) is None else _words(part, "METHOD") for _, part in parts
        )
    )


def _words(part: PhaseFunction, name: str) -> str:
    """Return what the module of a kind says of itself."""
    words: str = getattr(module_of(part, ROOM), name, "as given" if name == "SOURCE" else "pdf as given")
    return words
