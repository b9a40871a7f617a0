"""Dot products, cross products and lengths of vectors in about twice the precision of float64.

A vector is a sequence of component arrays; (x, x_low) stands for the unevaluated sum x + x_low. The error is relative to the
lengths of the vectors, for components between 1e-140 and 1e140 or so; smaller ones beside them do no harm.
Source: Ogita, Rump & Oishi 2005, Accurate sum and dot product, algorithm 5.3; Dekker 1971.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

Vector = Sequence[np.ndarray] | np.ndarray
Pair = tuple[np.ndarray, np.ndarray]


class Split(NamedTuple):
    """A number and its halves of 26 bits, value = high + low."""

    value: np.ndarray
    high: np.ndarray
    low: np.ndarray


def split(x: Vector) -> list[Split]:
    """Return the components, ready for exact products."""
    result = []
    for xi in x:
        scaled = xi * 134217729.0  # 2^27 + 1
        high = scaled - (scaled - xi)
        result.append(Split(xi, high, xi - high))
    return result


def sum_pair(x: np.ndarray, y: np.ndarray) -> Pair:
    """Return (x + y rounded, its rounding error) for finite numbers (Knuth 1969)."""
    value = x + y
    part = value - x
    return value, (x - (value - part)) + (y - part)


def product_pair(x: Split, y: Split) -> Pair:
    """Return (x y rounded, its rounding error)."""
    value = x.value * y.value
    return value, ((x.high * y.high - value) + (x.high * y.low + x.low * y.high)) + x.low * y.low


def dot(x: Sequence[Split], x_low: Vector, y: Sequence[Split]) -> Pair:
    """Return the pair of (x + x_low) . y."""
    total, low = product_pair(x[0], y[0])
    low += x_low[0] * y[0].value
    for xi, xi_low, yi in zip(x[1:], x_low[1:], y[1:], strict=True):
        term, rest = product_pair(xi, yi)
        total, carry = sum_pair(total, term)
        low += (rest + carry) + xi_low * yi.value
    return sum_pair(total, low)


def cross(x: Sequence[Split], x_low: Vector, y: Sequence[Split]) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return (x + x_low) cross y: components rounded, and what they lack."""
    pairs = []
    for j, k in ((1, 2), (2, 0), (0, 1)):
        (one, one_rest), (two, two_rest) = product_pair(x[j], y[k]), product_pair(x[k], y[j])
        total, carry = sum_pair(one, -two)
        low = (one_rest - two_rest) + carry + (x_low[j] * y[k].value - x_low[k] * y[j].value)
        pairs.append(sum_pair(total, low))
    return [p[0] for p in pairs], [p[1] for p in pairs]


def hypot(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return sqrt(x^2 + y^2), relative error below 2^-52: a few times faster than np.hypot, which is kept for the extremes."""
    value = np.sqrt(x * x + y * y)
    extreme = ~((value > 1e-140) & (value < 1e140))
    if extreme.any():
        value = np.where(extreme, np.hypot(x, y), value)
    return value


def norm(x: Vector, x_low: Vector) -> Pair:
    """Return the pair of |x + x_low|, for components of any size."""
    largest = np.abs(x[0])
    for xi in x[1:]:
        largest = np.maximum(largest, np.abs(xi))
    extreme = bool(np.any((largest > 1e140) | ((largest < 1e-140) & (largest > 0))))
    if extreme:
        exponent = -np.frexp(largest)[1]
        x, x_low = [np.ldexp(xi, exponent) for xi in x], [np.ldexp(xi, exponent) for xi in x_low]
    root, low = root_pair(*square(split(x), x_low))
    return (np.ldexp(root, -exponent), np.ldexp(low, -exponent)) if extreme else (root, low)


def square(x: Sequence[Split], x_low: Vector) -> Pair:
    """Return the pair of |x + x_low|^2."""
    total, low = dot(x, x_low, x)
    for xi, xi_low in zip(x, x_low, strict=True):
        low = low + xi.value * xi_low  # the dot product has it once
    return sum_pair(total, low)


def root_pair(x: np.ndarray, x_low: np.ndarray) -> Pair:
    """Return the pair of the square root of x + x_low >= 0: one Newton step from the rounded root."""
    root = np.sqrt(x)
    (halves,) = split([root])
    again, rest = product_pair(halves, halves)
    step = ((x - again) - rest) + x_low
    low = np.divide(step, 2 * root, out=np.zeros_like(step), where=root > 0)
    return sum_pair(root, low)
