"""Arithmetic on pairs (value, low) that stand for the unevaluated sum value + low: about 106 bits.

The oracle carries lengths and plane crossings in pairs, so that neither the position of the camera nor the number of
crossings costs accuracy. Every operation is off by less than 8 * 2^-106 relative, `dot` relative to the sum of |a_i b_i|.
Infinite values keep low = 0.
Source: Dekker 1971; Joldes, Muller & Popescu 2017, Tight and rigorous error bounds for basic building blocks of
double-word arithmetic, algorithms 6, 9, 12 and 17.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import two_prod, two_sum

Pair = tuple[np.ndarray, np.ndarray]

SMALL = 1e-100
"""Components of vectors in a dot product below this count as 0, so that no product of two underflows."""

UNIT = 2.0**-100
"""A generous bound of the relative error of a short chain of these operations; nothing the oracle says rests on less."""


def pair(x: Any) -> Pair:
    """Return a float64 array as an exact pair."""
    x = np.asarray(x, float)
    return x, np.zeros_like(x)


def add(x: Pair, y: Pair) -> Pair:
    """Return x + y."""
    value, low = two_sum(x[0], y[0])
    lows, rest = two_sum(x[1], y[1])
    value, low = two_sum(value, low + lows)
    return two_sum(value, low + rest)


def negative(x: Pair) -> Pair:
    """Return -x."""
    return -x[0], -x[1]


def times(x: Pair, y: Pair) -> Pair:
    """Return x y."""
    value, low = two_prod(x[0], y[0])
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        cross = x[0] * y[1] + x[1] * y[0]
    return two_sum(value, np.where(np.isfinite(value), low + cross, 0.0))


def divide(x: Pair, y: Pair) -> Pair:
    """Return x / y, for y != 0."""
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        first = x[0] / y[0]
        rest = add(x, negative(times(pair(first), y)))
        second = rest[0] / y[0]
    return two_sum(first, np.where(np.isfinite(first) & np.isfinite(second), second, 0.0))


def square_root(x: Pair) -> Pair:
    """Return the square root of x >= 0."""
    root = np.sqrt(x[0])
    with np.errstate(invalid="ignore"):
        rest = add(x, negative(two_prod(root, root)))
    low = np.divide(rest[0], 2 * root, out=np.zeros_like(root), where=(root > 0) & np.isfinite(root))
    return two_sum(root, low)


def dot(a: Any, b: Any) -> Pair:
    """Return the dot product over the last axis of float64 arrays, whose components below SMALL count as 0."""
    a, b = np.broadcast_arrays(flushed(a), flushed(b))
    total = two_prod(a[..., 0], b[..., 0])
    for i in range(1, a.shape[-1]):
        total = add(total, two_prod(a[..., i], b[..., i]))
    return total


def dot_error(a: Any, b: Any) -> np.ndarray:
    """Return a bound of the error of `dot`."""
    return UNIT * np.sum(np.abs(flushed(a) * flushed(b)), axis=-1)


def flushed(x: Any) -> np.ndarray:
    """Return x with every component below SMALL taken as 0."""
    x = np.asarray(x, float)
    return np.where(np.abs(x) < SMALL, 0.0, x)


def total(x: Pair) -> Pair:
    """Return the sum over the last axis, which is not empty, halving it until one element is left."""
    while x[0].shape[-1] > 1:
        half = x[0].shape[-1] // 2
        value, low = add((x[0][..., :half], x[1][..., :half]), (x[0][..., half : 2 * half], x[1][..., half : 2 * half]))
        x = (
            np.concatenate([value, x[0][..., 2 * half :]], axis=-1),
            np.concatenate([low, x[1][..., 2 * half :]], axis=-1),
        )
    return x[0][..., 0], x[1][..., 0]


def less(x: Pair, y: Pair) -> np.ndarray:
    """Return where x < y."""
    return (x[0] < y[0]) | ((x[0] == y[0]) & (x[1] < y[1]))


def each(function: Callable[[np.ndarray], np.ndarray], x: Pair) -> Pair:
    """Return both parts rearranged by a function that computes nothing: an index, a new axis, another order."""
    return function(x[0]), function(x[1])


def where(condition: np.ndarray, x: Pair, y: Pair) -> Pair:
    """Return x where the condition holds, y elsewhere."""
    return np.where(condition, x[0], y[0]), np.where(condition, x[1], y[1])
