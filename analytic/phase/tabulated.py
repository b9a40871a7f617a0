"""A phase function that is linear between tabulated values, divided by its own integral."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase, Array
from fogproof.analytic.arithmetic.error_free import EPS
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
    left, right = c[i], c[i + 1]
    return i, (f[i] * (right - mu) + f[i + 1] * (mu - left)) / (right - left)


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
