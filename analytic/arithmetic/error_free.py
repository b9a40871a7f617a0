"""Sums and products whose rounding error is known exactly, and what an accurate exp(-sigma s) needs of them.

The rounding of tau = sigma s alone costs exp(-tau) a relative error of tau/2 eps: 8e-14 at tau = 700. Carried along as
a second number it costs nothing. Pairs are (value, low): value is the rounded result, value + low the exact one.
"""

from __future__ import annotations

from typing import Any

import numpy as np

EPS = 2.0**-52
"""The spacing of float64 at 1; one rounding is off by at most EPS / 2 relative."""

TINY = 2.0**-1074
"""The smallest positive float64: the absolute error of a result that underflows."""

ELEMENTARY = 4 * EPS
"""Bound of the relative error of NumPy's exp, expm1, log1p … in any of its builds (glibc is below 1 EPS)."""


def two_sum(a: Any, b: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return (a + b rounded, low) with value + low = a + b exactly; low = 0 where the sum is not finite.

    Source: Knuth 1969, The Art of Computer Programming 2, section 4.2.2, theorem B.
    """
    a, b = np.asarray(a, float), np.asarray(b, float)
    with np.errstate(over="ignore", invalid="ignore"):
        value = a + b
        b_part = value - a
        low = (a - (value - b_part)) + (b - b_part)
    return value, np.where(np.isfinite(value), low, 0.0)


def two_prod(a: Any, b: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return (a b rounded, low) with value + low = a b exactly where |a b| > 1e-290, else within 2 TINY.

    Nothing overflows on the way: the factors are taken apart as mantissas in [1/2, 1). low = 0 where the product is
    not finite.
    Source: Veltkamp 1968; Dekker 1971, A floating-point technique for extending the available precision, (5.12).
    """
    (a, a_exponent), (b, b_exponent) = np.frexp(np.asarray(a, float)), np.frexp(np.asarray(b, float))
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        value = a * b
        (a_high, a_low), (b_high, b_low) = _halves(a), _halves(b)
        low = a_low * b_low - (((value - a_high * b_high) - a_low * b_high) - a_high * b_low)
        exponent = a_exponent + b_exponent
        value, low = np.ldexp(value, exponent), np.ldexp(low, exponent)
    return value, np.where(np.isfinite(value), low, 0.0)


def _halves(mantissa: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return two numbers of at most 26 bits each whose sum is `mantissa`."""
    scaled = 134217729.0 * mantissa  # 2^27 + 1
    high = scaled - (scaled - mantissa)
    return high, mantissa - high


def sum_times(a: Any, b: Any, s: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the pair of (a + b) s for a, b >= 0 and s in [0, inf]; 0 where a + b = 0, even at s = inf."""
    sigma, sigma_low = two_sum(a, b)
    s = np.where(sigma > 0, np.asarray(s, float), 0.0)
    value, low = two_prod(sigma, s)
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        return value, np.where(np.isfinite(value), low + sigma_low * s, 0.0)


def exp_minus(value: Any, low: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return exp(-(value + low)) and a bound of its error, for a pair with value >= 0.

    The error is relative, whatever the value, until the result leaves the normal numbers (value > 708).
    """
    with np.errstate(under="ignore"):
        result = np.exp(-np.asarray(value, float))
        # low is at most half a spacing of value, 6e-14 where the result is not 0: first order is exact to 2e-27.
        result = result - result * low
        return result, (ELEMENTARY + EPS) * result + 2 * TINY
