"""The airlight integral with an enclosure proven by ball arithmetic.

With t = h sinh s the integrand is exp(-sigma_t (h e^s - a)) 4 pi f_p(-tanh s) / (h cosh s), analytic around the real
line, which `acb.integral` integrates with proven error. An infinite ray is cut where the rest is provably small; on
the line of the light (h = 0) there are closed forms.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fogproof.analytic.proven.balls import Ball, flint, proven, rational, reference
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene.phase_functions import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    Mixture,
    Murky,
    PhaseFunction,
    Rayleigh,
    Schlick,
)

SOURCE = "Johansson 2018, Numerical integration in arbitrary-precision ball arithmetic"


def rigorous_airlight(
    sigma_t: np.ndarray, h: np.ndarray, a: np.ndarray, b: np.ndarray, phase: PhaseFunction
) -> Reference:
    """Return the airlight integral as `airlight_integral` does, proven; all four arrays of one shape."""
    rows = zip(sigma_t.ravel(), h.ravel(), a.ravel(), b.ravel(), strict=True)
    return reference([airlight_ball(*row, phase) for row in rows], h.shape, SOURCE)


def airlight_ball(sigma_t: float, h: float, a: float, b: float, phase: PhaseFunction) -> Ball:
    """Return one airlight integral [1/m] as a ball of 38 digits."""
    arb = flint().arb
    factor(phase, flint().acb(0))  # refuses what has no formula, here: inside `acb.integral` an exception is lost
    if a == b:
        return arb(0)
    if h == 0 and a <= 0 <= b:
        return arb.pos_inf()
    end = None if math.isinf(b) else rational(b)
    compute = _beside if h else _on_the_line
    return proven(lambda: compute(rational(sigma_t), rational(h), rational(a), end, phase))


def factor(phase: PhaseFunction, mu: Any, analytic: bool = False) -> Any:
    """Return 4 pi f_p at a complex ball mu of forward cosines, by the textbook formulas."""
    match phase:
        case Isotropic():
            return mu * 0 + 1
        case HenyeyGreenstein(g):
            return _draine(rational(g), flint().fmpq(0), mu, analytic)
        case CornetteShanks(g):
            return _draine(rational(g), flint().fmpq(1), mu, analytic)
        case Draine(g, alpha):
            return _draine(rational(g), rational(alpha), mu, analytic)
        case Rayleigh():
            return 3 * (1 + mu * mu) / 4
        case Schlick(k):
            exact = rational(k)
            return (1 - exact * exact) / (1 - exact * mu) ** 2
        case Hazy():
            return (1 + 9 * ((1 + mu) / 2) ** 8) / 2
        case Murky():
            return (1 + 33 * ((1 + mu) / 2) ** 32) / 2
        case DoubleHenyeyGreenstein(g1, g2, weight):
            first, second = (factor(HenyeyGreenstein(g), mu, analytic) for g in (g1, g2))
            return rational(weight) * first + (1 - rational(weight)) * second
        case Mixture(components, weights):
            exact_weights = [rational(w) for w in weights]
            parts = zip(exact_weights, components, strict=True)
            total = sum((w * factor(part, mu, analytic) for w, part in parts), mu * 0)
            return total / sum(exact_weights, flint().fmpq(0))
    raise UnsupportedError(f"nothing is proven for the phase function {phase!r}: ask without rigorous=True", "phase")


def peak(phase: PhaseFunction) -> Any:
    """Return an upper bound of 4 pi f_p."""
    match phase:
        case HenyeyGreenstein(g) | CornetteShanks(g) | Draine(g, _) | Schlick(g):
            size = abs(rational(g))
            extra = 1 + rational(phase.alpha) if isinstance(phase, Draine) else 2
            return extra * (1 + size) / (1 - size) ** 2
        case DoubleHenyeyGreenstein(g1, g2, _):
            return peak(HenyeyGreenstein(g1)) + peak(HenyeyGreenstein(g2))
        case Mixture(components, _):
            return sum((peak(part) for part in components), flint().fmpq(0))
    return flint().fmpq(17)


def _draine(g: Any, alpha: Any, mu: Any, analytic: bool) -> Any:
    distance = 1 + g * g - 2 * g * mu
    lobe = (1 - g * g) / (distance * flint().acb(distance).sqrt(analytic=analytic))
    return lobe * (1 + alpha * mu * mu) / (1 + alpha * (1 + 2 * g * g) / 3)


def _beside(sigma: Any, h: Any, a: Any, b: Any, phase: PhaseFunction) -> Ball:
    arb, acb = flint().arb, flint().acb
    start = arb(a / h).asinh()
    first = arb(h) * start.exp()
    # exp(-sigma r_a) stands before the integral, so that no tolerance is lost where all of it is tiny.
    front = (-(sigma * (first - a))).exp()

    def integrand(s: Any, analytic: bool) -> Any:
        return (-(sigma * (h * s.exp() - first))).exp() * factor(phase, -s.tanh(), analytic) / (h * s.cosh())

    bits = flint().ctx.prec
    if b is not None:
        end, rest = arb(b / h).asinh(), arb(0)
    else:
        # 1/cosh s <= 2 e^-s, so what lies beyond s is at most max f_p exp(-sigma (h e^s - first)) 2 e^-s / h.
        end = start.max(arb(0)) + bits
        if sigma:
            end = end.min(((first + bits / sigma) / h).log())
        bound = peak(phase) * (-(sigma * (h * end.exp() - first))).exp() * 2 * (-end).exp() / h
        rest = arb(0).union(bound.upper())
    inside = acb.integral(integrand, acb(start), acb(end), abs_tol=arb(0)).real
    return front * (inside + rest)


def _on_the_line(sigma: Any, _h: Any, a: Any, b: Any, phase: PhaseFunction) -> Ball:
    """Return the integral for h = 0: r = -t and all path lengths equal before the light, r = t behind it."""
    arb, acb = flint().arb, flint().acb
    ahead = a < 0
    facing = factor(phase, acb(1 if ahead else -1)).real
    if ahead:
        return facing * (sigma * arb(a)).exp() * (1 / arb(-b) - 1 / arb(-a))
    if not sigma:
        return facing * (1 / arb(a) - (0 if b is None else 1 / arb(b)))
    parts = [(2 * sigma * arb(x)).expint(2) / x for x in (a, b) if x is not None]
    return facing * (sigma * arb(a)).exp() * (parts[0] - (parts[1] if b is not None else 0))
