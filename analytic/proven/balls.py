"""Ball arithmetic: answers that are proven, not estimated (extra `rigorous`, python-flint).

A ball is a midpoint and a radius; every operation returns a ball that contains the result for every point of its
operands. Inputs are exact rational numbers, so the last ball of a computation contains the truth. If it is too wide,
the computation is repeated with more bits.
Source: Johansson 2017, Arb: efficient arbitrary-precision midpoint-radius interval arithmetic.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.double_double import SMALL
from fogproof.contracts import Reference
from fogproof.errors import NotInstalledError, UnsupportedError

BITS = 128
"""Relative accuracy of a proven answer: 38 digits."""

MOST_BITS = 1 << 15
"""Working precision at which an answer that is still too wide is given up."""

ProvenBall = Any
"""A `flint.arb`; python-flint has no types."""


def flint() -> Any:
    """Return the module python-flint, or say how to install it."""
    try:
        import flint
    except ImportError:
        raise NotInstalledError("python-flint", "rigorous") from None
    return flint


def rational(x: Any) -> Any:
    """Return a finite float64 as an exact rational number (`flint.fmpq`)."""
    return flint().fmpq(*float(x).as_integer_ratio())


def vector(x: Any) -> list[Any]:
    """Return exact components; those below 1e-100 count as 0, as everywhere in heterogeneous media."""
    return [rational(0.0 if abs(v) < SMALL else v) for v in np.asarray(x, float)]


def proven(compute: Callable[[], ProvenBall]) -> ProvenBall:
    """Return the ball of `compute()`, repeated with more working bits until it is BITS accurate; inf is a result too."""
    ctx = flint().ctx
    bits = 2 * BITS
    while bits <= MOST_BITS:
        with ctx.workprec(bits):
            ball = flint().arb(compute())
            if ball.is_zero() or ball == flint().arb.pos_inf() or ball.rel_accuracy_bits() >= BITS:
                return ball
        bits *= 2
    raise UnsupportedError(f"no enclosure with {MOST_BITS} bits: ask without rigorous=True")


def reference(balls: Iterable[ProvenBall], shape: tuple[int, ...], source: str) -> Reference:
    """Return the balls as a `Reference`: the nearest float64, and a bound of its distance from all of the ball."""
    rounded = [_rounded(ball) for ball in balls]
    value, error = (np.array(column, float).reshape(shape) for column in zip(*rounded, strict=True)) if rounded else (
        np.zeros(shape),
        np.zeros(shape),
    )  # fmt: skip
    return Reference(value, error, "proven by ball arithmetic", source)


def _rounded(ball: ProvenBall) -> tuple[float, float]:
    if not ball.is_finite():
        return math.inf, 0.0
    value = float(ball.mid())
    if math.isinf(value):
        return value, math.inf
    with flint().ctx.workprec(4 * BITS):
        off = (ball - flint().arb(value)).abs_upper()
        return value, 0.0 if off == 0 else math.nextafter(float(off), math.inf)
