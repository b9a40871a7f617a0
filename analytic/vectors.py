"""Dot products, cross products and lengths of vectors in about twice the precision of float64.

A vector is a sequence of component arrays; (x, x_low) stands for the unevaluated sum x + x_low. Products of small
components underflow harmlessly: the error is always relative to the lengths of the vectors, except far below 1e-150.
Source: Ogita, Rump & Oishi 2005, Accurate sum and dot product, algorithm 5.3.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fogproof.analytic.error_free import two_sum

Vector = Sequence[np.ndarray] | np.ndarray
Pair = tuple[np.ndarray, np.ndarray]


def dot(x: Vector, x_low: Vector, y: Vector) -> Pair:
    """Return the pair of (x + x_low) . y, for components below 1e150."""
    total, low = product(x[0], y[0])
    low = low + x_low[0] * y[0]
    for xi, xi_low, yi in zip(x[1:], x_low[1:], y[1:], strict=True):
        term, rest = product(xi, yi)
        total, carry = two_sum(total, term)
        low = low + ((rest + carry) + xi_low * yi)
    return two_sum(total, low)


def cross(x: Vector, x_low: Vector, y: Vector) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return the three pairs of (x + x_low) cross y: components rounded, and what they lack."""
    pairs = [dot((x[j], x[k]), (x_low[j], x_low[k]), (y[k], -y[j])) for j, k in ((1, 2), (2, 0), (0, 1))]
    return [p[0] for p in pairs], [p[1] for p in pairs]


def norm(x: Vector, x_low: Vector) -> Pair:
    """Return the pair of |x + x_low|, for components of any size: one Newton step from the rounded length."""
    largest = np.max(np.abs(np.stack(np.broadcast_arrays(*x))), axis=0)
    exponent = -np.frexp(largest)[1]
    x, x_low = [np.ldexp(xi, exponent) for xi in x], [np.ldexp(xi, exponent) for xi in x_low]
    square, rest = dot(x, x_low, x)
    twice = sum((xi * xi_low for xi, xi_low in zip(x, x_low, strict=True)), np.zeros(()))  # dot has it once
    root = np.sqrt(square)
    root_square, root_rest = product(root, root)
    step = ((square - root_square) - root_rest) + (rest + twice)
    low = np.divide(step, 2 * root, out=np.zeros_like(step), where=root > 0)
    root, low = two_sum(root, low)
    return np.ldexp(root, -exponent), np.ldexp(low, -exponent)


def product(x: np.ndarray, y: np.ndarray) -> Pair:
    """Return (x y rounded, its rounding error) for |x|, |y| < 1e150 (Dekker 1971)."""
    value = x * y
    (x_high, x_low), (y_high, y_low) = _split(x), _split(y)
    return value, ((x_high * y_high - value) + (x_high * y_low + x_low * y_high)) + x_low * y_low


def _split(x: np.ndarray) -> Pair:
    scaled = x * 134217729.0  # 2^27 + 1
    high = scaled - (scaled - x)
    return high, x - high
