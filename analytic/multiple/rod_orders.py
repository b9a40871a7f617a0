"""Scattering orders of a rod, by doubling layers whose reflection and transmission are power series in the albedo.

With a = (1 + g)/2 and b = (1 - g)/2 a rod that grows by dL at its end obeys

    dR/dL = c b + 2 (c a - 1) R + c b R^2,      dT/dL = T (c a - 1 + c b R),

whose power series in L gives a thin rod; two of them on one another are

    R' = R + T^2 R / (1 - R^2),      T' = T^2 / (1 - R^2).

All coefficients are positive, so nothing cancels: each keeps its digits however deep the rod and high the order.
Source: Ambarzumian 1943, Bellman & Kalaba 1956 (invariant imbedding); van de Hulst 1980, section 4.4 (doubling).
"""

from __future__ import annotations

import math

import numpy as np

from fogproof.analytic.arithmetic.blocks import in_blocks
from fogproof.analytic.arithmetic.error_free import EPS, TINY

THIN, FEWEST, TERMS = 2.0**-12, 10, 12
"""Length of the first rod, doublings at least, and terms of its power series.

What is left out, relative: 2^-12 for each term, and 2^-10 for each scattering that has to happen in the same of 2^10 parts.
"""

DEEPEST = 1e6
"""Length beyond which a rod sends back what an endless one does after a number of scatterings, and passes nothing."""

BLOCK = 65_536
"""Coefficients of one series that are in memory at the same time."""

RENEWED = 2
"""EPS of relative error for each doubling and factor of a product; a fifteenth of that was the most to be seen."""


def rod_orders(L: np.ndarray, g: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Return R_n and T_n for n = 0 … count, (..., count + 1) each, their relative error (count + 1,), and what underflows.

    L  (...) length in mean free paths
    g  (...) mean cosine
    """
    L = np.minimum(L, DEEPEST)
    times = max(FEWEST, math.ceil(math.log2(max(float(np.max(L, initial=0.0)), THIN) / THIN)))
    size = max(1, BLOCK // (count + 1))
    with np.errstate(under="ignore"):
        R, T = in_blocks(lambda some, its_g: _doubled(some, its_g, count, times), size, L, g)
    n = np.arange(count + 1)
    return R, T, RENEWED * EPS * (times + 1) * (n + 2), 2.0**times * (count + 1) * TINY


def _doubled(L: np.ndarray, g: np.ndarray, count: int, times: int) -> tuple[np.ndarray, np.ndarray]:
    """Return R_n and T_n (v, count + 1) of rods that are doubled so many times."""
    R, T = _thin(L * 2.0**-times, (1 + g) / 2, (1 - g) / 2, count)
    for i in range(times):
        square = _product(T, T)
        between = _inverse(_product(R, R))
        R, T = R + _product(_product(square, R), between), _product(square, between)
        T[..., 0] = np.exp(-L * 2.0 ** (i + 1 - times))
    return R, T


def _thin(L: np.ndarray, a: np.ndarray, b: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the series in the albedo of rods of at most `THIN`."""
    zero = np.zeros((*L.shape, count + 1))
    R, T = [zero], [zero.copy()]
    T[0][..., 0] = 1.0
    for m in range(TERMS):
        double = sum((_product(R[i], R[m - i]) for i in range(m + 1)), zero)
        both = sum((_product(R[i], T[m - i]) for i in range(m + 1)), zero)
        alone = _scattered(np.where(np.arange(count + 1) == 0, float(m == 0), zero), b)
        R.append((alone + 2 * (_scattered(R[m], a) - R[m]) + _scattered(double, b)) / (m + 1))
        T.append((_scattered(T[m], a) - T[m] + _scattered(both, b)) / (m + 1))
    power = np.power(L[..., None, None], np.arange(TERMS + 1.0))
    R_sum, T_sum = (np.einsum("...nm,...m->...n", np.stack(x, axis=-1), power[..., 0, :]) for x in (R, T))
    T_sum[..., 0] = np.exp(-L)
    return R_sum, T_sum


def _scattered(series: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Return c times the series, times a share (...)."""
    found = np.zeros_like(series)
    found[..., 1:] = series[..., :-1] * share[..., None]
    return found


def _product(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the product of two power series, as far as they go."""
    found = np.zeros_like(x)
    for i in range(x.shape[-1]):
        found[..., i:] += x[..., i, None] * y[..., : x.shape[-1] - i]
    return found


def _inverse(x: np.ndarray) -> np.ndarray:
    """Return 1/(1 - x) for a series that starts at c^1 or later."""
    found = np.zeros_like(x)
    found[..., 0] = 1.0
    for n in range(1, x.shape[-1]):
        found[..., n] = np.sum(x[..., 1 : n + 1] * found[..., n - 1 :: -1][..., :n], axis=-1)
    return found
