"""The truth of a formula to 50 digits, and how much exact arguments matter: ball arithmetic with as many bits as it takes.

Source: Johansson 2017, Arb: efficient arbitrary-precision midpoint-radius interval arithmetic.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fogproof.errors import NotInstalledError

BITS = 167
"""Of a truth: 50 digits."""

MOST_BITS = 1 << 14

NOTHING = 6000
"""A ball around 0 within 2^-NOTHING is 0: no formula of numbers as small as floats are comes as near without being it."""

STEP = 128
"""Arguments are moved by 2^-STEP of themselves to see what they do to the value."""


class ExactValue(NamedTuple):
    """A value to 50 digits, and sum |x_i df/dx_i| over its arguments; both `flint.arb`, the second good to a few digits.

    The condition number is `reach` / |value|: what a relative change of the arguments becomes in the value.
    """

    value: Any
    reach: Any


def flint() -> Any:
    """Return the module python-flint, or say how to install it."""
    try:
        import flint
    except ImportError:
        raise NotInstalledError("python-flint", "rigorous") from None
    return flint


def number(x: float) -> Any:
    """Return a float as an exact ball."""
    return flint().arb(float(x)) if math.isfinite(x) else flint().arb("inf" if x > 0 else "-inf")


def exactly(formula: Callable[..., Any], arguments: dict[str, float], condition: bool = True) -> ExactValue:
    """Return a formula at exact arguments; `ArithmeticError` if no precision within reason encloses it.

    condition  whether what the arguments do is wanted; 0 stands for it otherwise
    """
    ctx, arb = flint().ctx, flint().arb
    bits = 2 * BITS
    while bits <= MOST_BITS:
        with ctx.workprec(bits):
            given = {name: number(float(x)) for name, x in arguments.items()}
            value = arb(formula(**given))
            if abs(value) < arb(2) ** -NOTHING:
                value = arb(0)
            if value == arb.pos_inf() or value.is_zero() or value.rel_accuracy_bits() >= BITS:
                return ExactValue(value, _reach(formula, given, value) if condition else arb(0))
        bits *= 2
    raise ArithmeticError(f"no enclosure of {formula.__name__} with {MOST_BITS} bits at {arguments}")


def _reach(formula: Callable[..., Any], given: dict[str, Any], value: Any) -> Any:
    """Return sum |x_i df/dx_i|, by differences: to one side, or to the other where the first leaves the domain."""
    ctx, arb = flint().ctx, flint().arb
    total = arb(0)
    if not value.is_finite():
        return total
    with ctx.workprec(ctx.prec + 2 * STEP):
        for name, x in given.items():
            if x.is_zero() or not x.is_finite():
                continue
            for sign in (1, -1):
                moved = arb(formula(**{**given, name: x * (1 + sign * arb(2) ** -STEP)}))
                change = abs(moved - value).upper() * arb(2) ** STEP
                if change.is_finite():
                    total += change
                    break
    return total.mid()


def inverted(cdf: Callable[[Any], Any], slope: Callable[[Any], Any], xi: Any) -> Any:
    """Return the x in [-1, 1] at which a distribution reaches xi, as a ball that Newton's interval operator proves.

    The logarithm of the distance to the nearer end is bisected, Newton's method doubles the digits; the last ball is one that
    the operator maps into itself.
    """
    ctx, arb = flint().ctx, flint().arb
    if xi <= 0 or xi >= 1:
        return arb(-1 if xi <= 0 else 1)
    upper = cdf(arb(0)) < xi

    def place(bits: float) -> Any:
        """Return the point at the distance 2^-bits from the end."""
        distance = arb(2) ** arb(-bits)
        return (1 - distance if upper else distance - 1).mid()

    near, far = 0.0, 1.0
    while (cdf(place(far)) < xi) == upper:
        near, far = far, 2 * far
    while far - near > 2.0**-8:
        middle = (near + far) / 2
        near, far = (middle, far) if (cdf(place(middle)) < xi) == upper else (near, middle)
    x = place((near + far) / 2)
    for _ in range(2 + ctx.prec.bit_length()):
        x = (x - (cdf(x) - xi) / slope(x)).mid()
    for spare in range(16, ctx.prec // 2, 16):
        around = x + arb(0, 1) * arb(2) ** (spare - ctx.prec)
        found = x - (cdf(x) - xi) / slope(around)
        if around.contains(found):
            return found
    return around
