"""A density on an interval as polynomials on panels, and its integral from the left end: a numerical cdf with an error bound."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.checks.density.quadrature import KRONROD, NODES, Leaves

_DEGREE = len(NODES) - 1


def legendre(s: np.ndarray, degree: int) -> np.ndarray:
    """Return (degree + 1, n) Legendre polynomials at s (n,) in [-1, 1]."""
    p = np.empty((degree + 1, len(s)))
    p[0] = 1.0
    if degree:
        p[1] = s
    for k in range(1, degree):
        p[k + 1] = ((2 * k + 1) * s * p[k] - k * p[k - 1]) / (k + 1)
    return p


TO_COEFFICIENTS = np.linalg.inv(legendre(NODES, _DEGREE).T).T
"""values (m, 15) at the Kronrod nodes @ this -> (m, 15) coefficients of the interpolating Legendre series."""


def _integrator() -> np.ndarray:
    """Return (15, 16): coefficients of a series -> those of its integral from -1."""
    matrix = np.zeros((_DEGREE + 1, _DEGREE + 2))
    matrix[0, :2] = 1.0
    for k in range(1, _DEGREE + 1):
        matrix[k, k + 1] += 1 / (2 * k + 1)
        matrix[k, k - 1] -= 1 / (2 * k + 1)
    return matrix


INTEGRATOR = _integrator()


def series_at(coefficients: np.ndarray, row: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return (n,) the Legendre series in `row` (n,) of the coefficients (m, d + 1), at s (n,) in [-1, 1]."""
    columns = np.ascontiguousarray(coefficients.T)
    before, now = np.ones_like(s), s
    total = columns[0][row] + columns[1][row] * s
    for k in range(1, len(columns) - 1):
        before, now = now, ((2 * k + 1) / (k + 1)) * (s * now) - (k / (k + 1)) * before
        total += columns[k + 1][row] * now
    return total


@dataclass(frozen=True)
class Curve:
    """Polynomials of degree 14 on panels.

    breaks        (m + 1,) ends of the panels, increasing
    coefficients  (m, 15) Legendre series of the density on each panel, over s in [-1, 1]
    cumulative    (m + 1,) integral from the left end to each break
    """

    breaks: np.ndarray
    coefficients: np.ndarray
    cumulative: np.ndarray

    @staticmethod
    def of(breaks: np.ndarray, values: np.ndarray) -> Curve:
        """Return the curve through the values (m, 15) at the Kronrod nodes of each panel."""
        values = np.where(np.isfinite(values), values, 0.0)
        integrals = 0.5 * np.diff(breaks) * (values @ KRONROD)
        return Curve(breaks, values @ TO_COEFFICIENTS, np.concatenate([[0.0], np.cumsum(integrals)]))

    @property
    def total(self) -> float:
        """The integral over everything."""
        return float(self.cumulative[-1])

    def _place(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        panel = np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, len(self.breaks) - 2)
        left, right = self.breaks[panel], self.breaks[panel + 1]
        return panel, np.clip((2 * t - left - right) / (right - left), -1, 1)

    def density(self, t: np.ndarray) -> np.ndarray:
        """Return the density at t (n,)."""
        return series_at(self.coefficients, *self._place(t))

    def cdf(self, t: np.ndarray) -> np.ndarray:
        """Return the integral from the left end to t (n,)."""
        panel, s = self._place(t)
        half = 0.5 * (self.breaks[panel + 1] - self.breaks[panel])
        return self.cumulative[panel] + half * series_at(self.coefficients @ INTEGRATOR, panel, s)

    def quantiles(self, shares: np.ndarray) -> np.ndarray:
        """Return about where the cdf reaches the given shares (n,) of the total: linear between the nodes of the panels."""
        nodes = np.concatenate([NODES, [1.0]])
        inner = (self.coefficients @ INTEGRATOR) @ legendre(nodes, _DEGREE + 1)
        half, middle = 0.5 * np.diff(self.breaks), 0.5 * (self.breaks[:-1] + self.breaks[1:])
        t = (middle[:, None] + half[:, None] * nodes).ravel()
        value = (self.cumulative[:-1, None] + half[:, None] * inner).ravel()
        value = np.maximum.accumulate(np.maximum(np.append(0.0, value), 0.0))
        return np.interp(shares * value[-1], value, np.append(self.breaks[0], t))


def curve_of_line(leaves: Leaves) -> Curve:
    """Return the curve of one-dimensional leaves that fill an interval."""
    order = np.argsort(leaves.low[:, 0])
    breaks = np.append(leaves.low[order, 0], leaves.high[order[-1], 0])
    return Curve.of(breaks, leaves.values[order])


def curve_along(leaves: Leaves, axis: int) -> Curve:
    """Return the marginal density of two-dimensional leaves along one axis: the other axis integrated out.

    The ends of all boxes cut the axis into strips; on each, the marginal is the sum of the polynomials of the boxes that cross it.
    """
    low, high = leaves.low[:, axis], leaves.high[:, axis]
    other = 0.5 * (leaves.high - leaves.low)[:, 1 - axis]
    values = np.where(np.isfinite(leaves.values), leaves.values, 0.0)
    across = values @ KRONROD if axis == 0 else np.einsum("mij,i->mj", values, KRONROD)
    coefficients = (across * other[:, None]) @ TO_COEFFICIENTS
    breaks = np.unique(np.concatenate([low, high]))
    first, last = np.searchsorted(breaks, low), np.searchsorted(breaks, high)
    counts = last - first
    box = np.repeat(np.arange(len(low)), counts)
    strip = np.arange(len(box)) - np.repeat(np.cumsum(counts) - counts, counts) + np.repeat(first, counts)
    width = (high - low)[box]
    middle, half = 0.5 * (breaks[strip] + breaks[strip + 1]), 0.5 * (breaks[strip + 1] - breaks[strip])
    s = (2 * (middle[:, None] + half[:, None] * NODES) - (low + high)[box][:, None]) / width[:, None]
    pieces = series_at(coefficients, np.repeat(box, len(NODES)), s.ravel()).reshape(s.shape)
    total = np.zeros((len(breaks) - 1, len(NODES)))
    np.add.at(total, strip, pieces)
    return Curve.of(breaks, total)


def coefficients_of(leaves: Leaves) -> np.ndarray:
    """Return (m, 15) or (m, 15, 15) the Legendre series of each box."""
    if leaves.low.shape[1] == 1:
        return leaves.values @ TO_COEFFICIENTS
    return TO_COEFFICIENTS.T @ leaves.values @ TO_COEFFICIENTS


def partial_error(leaves: Leaves) -> np.ndarray:
    """Return (m,) a bound on the error of the integral of a box's polynomial over any part of the box.

    The last terms of a Legendre series tell how fast it converges; the integral of a term over a part is less than a quarter of it.
    """
    size = np.abs(coefficients_of(leaves))
    axes = tuple(range(1, size.ndim))
    size[size <= 4 * leaves.noise * np.max(np.abs(leaves.values), axis=axes, keepdims=True)] = 0.0
    last = size[:, -2:].sum(axis=axes) + (size[:, :, -2:].sum(axis=axes) if size.ndim == 3 else 0.0)
    return np.maximum(last * np.prod(0.5 * (leaves.high - leaves.low), axis=1), leaves.error)


def error_along(leaves: Leaves, axis: int, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return bounds on errors of the marginal cdf at t (n,): of the whole boxes before t, and of the parts of those that t cuts.

    The error of a probability between two such points is at most the difference of the first and the sum of the second.
    """
    by_low, by_high = np.argsort(leaves.low[:, axis]), np.argsort(leaves.high[:, axis])
    begun = np.searchsorted(leaves.low[by_low, axis], t, side="left")
    ended = np.searchsorted(leaves.high[by_high, axis], t, side="right")
    partial = partial_error(leaves)
    whole, first, last = (
        np.concatenate([[0.0], np.cumsum(e)]) for e in (leaves.error[by_high], partial[by_low], partial[by_high])
    )
    with np.errstate(invalid="ignore"):
        cut = np.maximum(first[begun] - last[ended], 0.0)
    return whole[ended], np.where(np.isfinite(cut), cut, np.inf)
