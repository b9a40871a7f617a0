"""Values of one argument that crowd where floating point fails; each maker returns (n, dtype) -> values."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.stability.formula import Values


def decades(low: float, high: float, *extra: float) -> Values:
    """Return values from low to high > 0 whose logarithms crowd around 0; what a type cannot hold is left out.

    low  0 stands for the least value of which every uniform's share is a normal number: 2e-292, or 2e-31 in single precision
    """

    def values(n: int, dtype: Any) -> np.ndarray:
        info = np.finfo(dtype)
        least = low or float(info.tiny) / float(info.epsneg)
        a, b = (float(np.log10(np.clip(x, float(info.tiny), float(info.max) / 2))) for x in (least, high))
        roots = np.linspace(np.sign(a) * abs(a) ** 0.5, np.sign(b) * abs(b) ** 0.5, n)
        powers = np.clip(np.sign(roots) * roots**2, a, b)
        return _sorted(np.concatenate([10.0**powers, extra]), dtype)

    return values


def both_signs(low: float, high: float, *extra: float) -> Values:
    """Return values of either sign, half of them each; 0 only where it is among the extra ones."""
    one = decades(low, high)

    def values(n: int, dtype: Any) -> np.ndarray:
        half = one(max(n // 2, 2), dtype).astype(float)
        return _sorted(np.concatenate([-half, half, extra]), dtype)

    return values


def including(values: Values, *extra: float) -> Values:
    """Return the same values and these."""
    return lambda n, dtype: _sorted(np.concatenate([values(n, dtype).astype(float), extra]), dtype)


def around(centre: float, least: float, most: float) -> Values:
    """Return the centre and values beside it, at relative distances from least to most on either side."""

    def values(n: int, dtype: Any) -> np.ndarray:
        off = both_signs(max(least, float(np.finfo(dtype).eps)), most)(n, dtype).astype(float)
        return _sorted(np.concatenate([centre * (1 + off), [centre]]), dtype)

    return values


def minus(values: Values) -> Values:
    """Return the same values below 0."""
    return lambda n, dtype: -values(n, dtype)[::-1]


def to_one(gap: float = 0.0, zero: float = 0.0) -> Values:
    """Return values in (0, 1) that crowd at both ends.

    gap   the smallest distance from 1, half the spacing of the type below 1 unless given
    zero  the smallest value but 0, which comes too; the smallest of the type's own uniforms, 2^-53 or 2^-24, unless given
    """

    def values(n: int, dtype: Any) -> np.ndarray:
        grain = float(np.finfo(dtype).epsneg)
        least, from_one = max(zero, float(np.finfo(dtype).tiny)) if zero else grain, max(gap, grain)
        half = max(n // 2, 3)
        low = 10.0 ** np.linspace(np.log10(least), np.log10(0.5), half)
        high = 1 - 10.0 ** np.linspace(np.log10(from_one), np.log10(0.49), half)
        return _sorted(np.concatenate([[0.0, least], low, high, [1 - from_one]]), dtype)

    return values


def uniforms(n: int, dtype: Any) -> np.ndarray:
    """Return uniforms as a generator draws them, multiples of 2^-53 or 2^-24: 0, the least, the largest, and what lies between."""
    grain = float(np.finfo(dtype).epsneg)
    return _sorted(np.floor(to_one()(n, dtype).astype(float) / grain) * grain, dtype)


fine_uniforms = to_one(zero=1e-300)
"""The same with uniforms below a generator's grain, as transformed and rescaled ones are."""


def symmetric(gap: float, least: float = 1e-300) -> Values:
    """Return values in (-1, 1) that crowd at 0 and at both ends, which they miss by `gap`; 0 comes too."""

    def values(n: int, dtype: Any) -> np.ndarray:
        quarter = max(n // 4, 3)
        near = max(gap, float(np.finfo(dtype).epsneg))
        low = 10.0 ** np.linspace(np.log10(max(least, float(np.finfo(dtype).tiny))), np.log10(0.5), quarter)
        high = 1 - 10.0 ** np.linspace(np.log10(near), np.log10(0.49), quarter)
        one = np.concatenate([low, high])
        return _sorted(np.concatenate([-one, [0.0], one]), dtype)

    return values


def cosines(n: int, dtype: Any) -> np.ndarray:
    """Return cosines, both ends among them."""
    return _sorted(np.concatenate([symmetric(1e-16)(n, dtype), [-1.0, 1.0]]), dtype)


def of(*chosen: float) -> Values:
    """Return these values, however many are asked for."""
    return lambda _n, dtype: _sorted(np.array(chosen, float), dtype)


def _sorted(values: np.ndarray, dtype: Any) -> np.ndarray:
    with np.errstate(over="ignore"):
        return np.unique(np.asarray(values).astype(dtype))
