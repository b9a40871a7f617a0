"""Phase functions that are sums of Legendre polynomials: everything else follows from the moments.

The moments chi_l come with errors; those of the polynomials were measured against 40 digits up to l = 2000, and are taken to be
half as large again. Terms are added in twice the precision, so that their number adds nothing.
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase, Array
from fogproof.analytic.arithmetic.error_free import EPS, two_sum
from fogproof.analytic.phase.legendre import legendre_polynomials

Pair = tuple[np.ndarray, np.ndarray]


def _of_polynomials(count: int) -> np.ndarray:
    """Return the absolute errors of P_0 … P_count and of one product."""
    return (3 + np.arange(count + 1) / 8) * EPS


def _sum(weights: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return sum_l weights_l P_l."""
    total, rest = np.zeros_like(x), np.zeros_like(x)
    for w, P in zip(weights, legendre_polynomials(weights.size - 1, x, y), strict=True):
        total, low = two_sum(total, w * P)
        rest = rest + low
    return total + rest


def weights(chi: np.ndarray, chi_error: np.ndarray) -> tuple[np.ndarray, float]:
    """Return (2 l + 1) chi_l, and the error of the sum of these times P_l."""
    factor = 2.0 * np.arange(chi.size) + 1
    return factor * chi, float(factor @ (chi_error + _of_polynomials(chi.size - 1) * np.abs(chi)))


def density(chi: np.ndarray, chi_error: np.ndarray, x: np.ndarray, y: np.ndarray) -> Pair:
    """Return f [1/sr] where (1 - mu)/2 = x and (1 + mu)/2 = y, never negative; the error is the same everywhere."""
    beta, error = weights(chi, chi_error)
    return np.maximum(_sum(beta, x, y), 0.0) / (4 * np.pi), np.full_like(x, error / (4 * np.pi))


def cdf(chi: np.ndarray, chi_error: np.ndarray, mu: np.ndarray) -> Pair:
    """Return F(mu) = (1 + mu)/2 + sum_(l > 0) chi_l (P_(l+1) - P_(l-1))/2."""
    # By parts: the weight of P_l is chi_(l-1) - chi_(l+1), and 1 - chi_1 that of P_0, where F(-1) = 0.
    padded = np.concatenate([chi, [0.0, 0.0]])
    slope = np.concatenate([[1 - padded[1]], padded[:-2] - padded[2:]])
    error = float(chi_error.sum() + _of_polynomials(chi.size) @ np.abs(slope)) + EPS
    total = _sum(slope, (1 - mu) / 2, (1 + mu) / 2)
    return np.clip(total / 2, 0, 1), np.full_like(mu, error)


def moments(chi: np.ndarray, chi_error: np.ndarray, count: int) -> Pair:
    """Return chi_0 … chi_count, 0 beyond the last."""
    value, error = np.zeros((2, count + 1))
    value[: chi.size], error[: chi.size] = chi[: count + 1], chi_error[: count + 1]
    return value, error


def airlight(chi: np.ndarray, chi_error: np.ndarray, floor: float = 0.0) -> AirlightPhase:
    """Return 4 pi f: of degree N in mu, its slope in the angle at most N times its greatest value (Bernstein's inequality)."""
    order = chi.size - 1
    beta, error = weights(chi, chi_error)
    most = float(np.abs(beta).sum()) + error

    def factor(w: Array, wt: Array) -> tuple[Array, Array]:
        value, off = density(chi, chi_error, (w / (w + wt)).ravel(), (wt / (w + wt)).ravel())
        return 4 * np.pi * value.reshape(w.shape), 4 * np.pi * off.reshape(w.shape)

    def slope(low: Array, _high: Array) -> tuple[Array, Array]:
        return np.zeros_like(low), np.full_like(low, order * most)

    return AirlightPhase(factor, floor, most, 4.0, slope, degree=max(order, 1), noisy=True)
