"""A phase function that is linear between tabulated values, divided by its own integral."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase, Array
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.arithmetic.gauss_legendre import NODES, WEIGHTS
from fogproof.analytic.phase.legendre import legendre_polynomials
from fogproof.scene.phase import Tabulated

SOURCE = "trapezoidal rule, exact for the linear interpolant"
METHOD = "closed form"


def _table(phase: Tabulated) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Return cosines, values, 2 pi times the integral up to each cosine, and a relative error that holds for all sums."""
    c, f = np.array(phase.cosines), np.array(phase.values)
    cells = np.pi * (c[1:] - c[:-1]) * (f[1:] + f[:-1])
    upto = np.concatenate([[0.0], np.cumsum(cells)])
    return c, f, upto, (c.size / 2 + 2) * EPS


def _interpolate(c: np.ndarray, f: np.ndarray, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the cell of each mu and the interpolated value: a mean with positive weights, relative error 3 eps."""
    i = np.clip(np.searchsorted(c, mu, side="right") - 1, 0, c.size - 2)
    width = c[i + 1] - c[i]
    # Shares first: a product with a width of 1e-308 would lose its digits.
    return i, f[i] * ((c[i + 1] - mu) / width) + f[i + 1] * ((mu - c[i]) / width)


def pdf(phase: Tabulated, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]; relative error (n/2 + 6) eps for n cosines."""
    c, f, upto, rounding = _table(phase)
    value = _interpolate(c, f, mu)[1] / upto[-1]
    return value, (rounding + 4 * EPS) * value


def cdf(phase: Tabulated, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu); relative error (n + 10) eps for n cosines."""
    c, f, upto, rounding = _table(phase)
    i, here = _interpolate(c, f, mu)
    value = (upto[i] + np.pi * (mu - c[i]) * (f[i] + here)) / upto[-1]
    return np.minimum(value, 1), (2 * rounding + 6 * EPS) * value


def mean_cosine(phase: Tabulated) -> tuple[float, float]:
    """Return the mean cosine; absolute error (n + 10) eps of the mean of |mu|, or somewhat more."""
    c, f, upto, rounding = _table(phase)
    width, left, right = c[1:] - c[:-1], c[:-1], c[1:]
    # int m f dm over a cell, with f at the ends weighted by 2/3 left + 1/3 right and the reverse
    moment = np.pi / 3 * width * (left * (2 * f[:-1] + f[1:]) + right * (f[:-1] + 2 * f[1:]))
    size = np.pi / 3 * width * (np.abs(left) * (2 * f[:-1] + f[1:]) + np.abs(right) * (f[:-1] + 2 * f[1:]))
    return float(moment.sum() / upto[-1]), float((2 * rounding + 6 * EPS) * size.sum() / upto[-1])


def legendre_moments(phase: Tabulated, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return chi_0 … chi_count by 28 Gauss-Legendre nodes in pieces of cells narrow enough for P_count; error (n + 20) eps.

    In the Bernstein ellipse e^r of a piece of half width h, Legendre polynomials are below exp(l eta) with
    sinh(eta/2) = sqrt(h) sinh(r/2) (the sum of the distances to -1 and 1 grows by no more than that to the ends of the piece),
    so N nodes are off by at most 64/15 f cosh(r) exp(l eta - 2 (N - 1) r)/(1 - exp(-2 r)) of the width
    (Trefethen 2013, theorem 19.3), here below 1e-17.
    """
    c, f, upto, rounding = _table(phase)
    r = np.linspace(1.0, 4.0, 13)
    room = (2 * (NODES.size - 1) * r - 41 - np.log(np.cosh(r) / -np.expm1(-2 * r))) / max(count, 1)
    widest = 2 * float(np.max(np.sinh(room / 2) / np.sinh(r / 2))) ** 2
    parts = np.ceil((c[1:] - c[:-1]) / widest).astype(int)
    cell = np.repeat(np.arange(len(parts)), parts)
    first = np.arange(len(cell)) - np.repeat(np.cumsum(parts) - parts, parts)
    value = np.zeros(count + 1)
    for block in np.split(np.arange(len(cell)), range(8192, len(cell), 8192)):
        i, k = cell[block, None], parts[cell[block], None]
        t = (first[block, None] + NODES) / k
        x, y = ((1 - c[i]) * (1 - t) + (1 - c[i + 1]) * t) / 2, ((1 + c[i]) * (1 - t) + (1 + c[i + 1]) * t) / 2
        mass = 2 * np.pi * (c[i + 1] - c[i]) / k * WEIGHTS * (f[i] * (1 - t) + f[i + 1] * t) / upto[-1]
        value += np.array([mass.ravel() @ P for P in legendre_polynomials(count, x.ravel(), y.ravel())])
    return value, np.full(count + 1, 2 * rounding + 16 * EPS)


def airlight(phase: Tabulated) -> AirlightPhase:
    """Return the linear interpolant of the table, divided by its integral; panels end at its cosines."""
    cosines, values = np.array(phase.cosines), np.array(phase.values)
    widths = np.diff(cosines)
    F = values * (2 / float(np.sum(widths * (values[1:] + values[:-1])) / 2))
    steep = float(np.max(np.abs(np.diff(F)) / widths))

    def factor(w: Array, wt: Array) -> Array:
        return np.interp((wt - w) / (wt + w), cosines, F)

    def slope(low: Array, _high: Array) -> tuple[Array, Array]:
        return np.zeros_like(low), np.full_like(low, steep)

    eps = 6.0 + len(F) / 2
    return AirlightPhase(factor, float(F.min()), float(F.max()), eps, slope, 4 * steep, 1, cosines[1:-1])
