"""The airlight integral with an enclosure proven by ball arithmetic.

With t = h sinh s the integrand is exp(-sigma_t (h e^s - a)) 4 pi f_p(-tanh s) / (h cosh s), analytic around the real
line, which `acb.integral` integrates with proven error. An infinite ray is cut where the rest is provably small; on
the line of the light (h = 0) there are closed forms.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fogproof.analytic.phase.kinds import ROOM, weighted_parts
from fogproof.analytic.proven.balls import ProvenBall, flint, proven, rational, reference
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError, shorten
from fogproof.scene.kinds import given
from fogproof.scene.phase import PhaseFunction

SOURCE = "Johansson 2018, Numerical integration in arbitrary-precision ball arithmetic"


def rigorous_airlight(
    sigma_t: np.ndarray, h: np.ndarray, a: np.ndarray, b: np.ndarray, phase: PhaseFunction
) -> Reference:
    """Return the airlight integral as `airlight_integral` does, proven; all four arrays of one shape."""
    rows = zip(sigma_t.ravel(), h.ravel(), a.ravel(), b.ravel(), strict=True)
    return reference([airlight_ball(*row, phase) for row in rows], h.shape, SOURCE)


def airlight_ball(sigma_t: float, h: float, a: float, b: float, phase: PhaseFunction) -> ProvenBall:
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
    return _mean(phase, "ball", mu, analytic)


def peak(phase: PhaseFunction, mu: Any) -> Any:
    """Return an upper bound of 4 pi f_p at forward cosines up to mu, a ball."""
    return _mean(phase, "peak", mu)


def _mean(phase: PhaseFunction, name: str, *arguments: Any) -> Any:
    total = flint().fmpq(0)
    for weight, part in weighted_parts(phase):
        known = given(part, ROOM, name)
        if known is None:
            raise UnsupportedError(
                f"nothing is proven for the phase function {shorten(part)}: ask without rigorous=True", "phase"
            )
        total = total + flint().fmpq(weight.numerator, weight.denominator) * known(part, *arguments)
    return total


def _beside(sigma: Any, h: Any, a: Any, b: Any, phase: PhaseFunction) -> ProvenBall:
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
        bound = peak(phase, -end.tanh()) * (-(sigma * (h * end.exp() - first))).exp() * 2 * (-end).exp() / h
        rest = arb(0).union(bound.upper())
    inside = acb.integral(integrand, acb(start), acb(end), abs_tol=arb(0)).real
    return front * (inside + rest)


def _on_the_line(sigma: Any, _h: Any, a: Any, b: Any, phase: PhaseFunction) -> ProvenBall:
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
