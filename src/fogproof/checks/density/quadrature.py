"""Adaptive Gauss-Kronrod quadrature over many boxes at once, in one or two dimensions, with an error bound for each.

Every box is evaluated at the 15 (or 15 x 15) Kronrod nodes; the difference from the embedded 7-point Gauss rule, sharpened as in
QUADPACK (Piessens et al. 1983, qk15), estimates its error. The worst boxes are halved, all of a round at once, until the sum of
the estimates is below the tolerance, or only rounding noise is left, or the evaluations are used up. Whatever error is left is
reported, never hidden. The values at the nodes are kept: between them the integrand is their interpolating polynomial.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

_POSITIVE_NODES = [
    0.991455371120812639206854697526329,
    0.949107912342758524526189684047851,
    0.864864423359769072789712788640926,
    0.741531185599394439863864773280788,
    0.586087235467691130294144691693013,
    0.405845151377397166906606412076961,
    0.207784955007898467600689403773245,
]
_KRONROD_HALF = [
    0.022935322010529224963732008058970,
    0.063092092629978553290700663189204,
    0.104790010322250183839876322541518,
    0.140653259715525918745189590510238,
    0.169004726639267902826583426598550,
    0.190350578064785409913256402421014,
    0.204432940075298892414161999234649,
]
_KRONROD_CENTRE = 0.209482141084727828012999174891714
_GAUSS_HALF = [
    0.129484966168869693270611432679082,
    0.279705391489276667901467771423780,
    0.381830050505118944950369775488975,
]
_GAUSS_CENTRE = 0.417959183673469387755102040816327

NODES = np.array([-x for x in _POSITIVE_NODES] + [0.0] + _POSITIVE_NODES[::-1])
KRONROD = np.array([*_KRONROD_HALF, _KRONROD_CENTRE, *_KRONROD_HALF[::-1]])
GAUSS = np.zeros(15)
GAUSS[1::2] = [*_GAUSS_HALF, _GAUSS_CENTRE, *_GAUSS_HALF[::-1]]

_BLOCK = 1 << 17  # evaluations handed to the integrand at once
_ROUNDING = 8 * 2.0**-53  # relative error that rounding adds to an integral
_NOISY = 16  # times the noise of the integrand: an error estimate that small is noise itself


@dataclass(frozen=True)
class Leaves:
    """Boxes that fill a region, with an integrand known at the Kronrod nodes of each.

    low, high    (m, k) corners, k = 1 or 2
    values       (m, 15) or (m, 15, 15) the integrand at the nodes, axis by axis
    error        (m,) bound on the error of each box's integral
    axis         (m,) the axis along which a box is worst resolved
    evaluations  of the integrand that it took
    noise        relative rounding error of the integrand
    """

    low: np.ndarray
    high: np.ndarray
    values: np.ndarray
    error: np.ndarray
    axis: np.ndarray
    evaluations: int
    noise: float = 0.0

    @property
    def integrals(self) -> np.ndarray:
        """The integral over each box, (m,)."""
        values = self.values
        for _ in range(self.low.shape[1]):
            values = values @ KRONROD
        return values * np.prod(0.5 * (self.high - self.low), axis=1)

    @property
    def total(self) -> float:
        """The integral over all boxes."""
        return float(np.sum(self.integrals))

    @property
    def total_error(self) -> float:
        """Bound on the error of `total`."""
        return float(np.sum(self.error))

    def joined(self, other: Leaves) -> Leaves:
        """Return the boxes of both, as of one integration."""
        columns = zip(self.columns, other.columns, strict=True)
        low, high, values, error, axis = (np.concatenate(pair) for pair in columns)
        return Leaves(low, high, values, error, axis, self.evaluations + other.evaluations, self.noise)

    def chosen(self, which: np.ndarray) -> Leaves:
        """Return some of the boxes; the evaluations stay counted."""
        low, high, values, error, axis = (column[which] for column in self.columns)
        return Leaves(low, high, values, error, axis, self.evaluations, self.noise)

    @property
    def columns(self) -> tuple[np.ndarray, ...]:
        """All that there is one of for each box."""
        return self.low, self.high, self.values, self.error, self.axis


def integrate(
    f: Callable[[np.ndarray], np.ndarray],
    low: np.ndarray,
    high: np.ndarray,
    tolerance: float,
    budget: int,
    noise: float = 2.0**-53,
) -> Leaves:
    """Integrate f over m boxes.

    f          (q, k) coordinates -> (q,) values
    low, high  (m, k) corners, k = 1 or 2
    tolerance  wanted bound on the sum of the errors
    budget     most evaluations of f
    noise      relative rounding error of f: boxes are not halved to resolve it, and their error is it
    """
    return refine(f, evaluate(f, low, high), tolerance, budget, noise)


def refine(
    f: Callable[[np.ndarray], np.ndarray], leaves: Leaves, tolerance: float, budget: int, noise: float = 2.0**-53
) -> Leaves:
    """Halve the worst boxes until the sum of the errors is below the tolerance or the budget is used up."""
    per_box = 15 ** leaves.low.shape[1]
    while True:
        noisy = leaves.error <= _NOISY * noise * np.abs(leaves.integrals)
        useful = ~(noisy | _smallest(leaves.low, leaves.high))
        if not np.sum(leaves.error, where=useful) > tolerance:
            break
        chosen = np.flatnonzero(useful & (leaves.error > tolerance / (2 * len(leaves.error))))
        room = (budget - leaves.evaluations) // (2 * per_box)
        chosen = chosen[np.argsort(leaves.error[chosen])[::-1][: max(room, 0)]]
        halved = split(f, leaves, chosen)
        if halved is leaves:
            break
        leaves = halved
    only = np.where(noisy, noise * np.abs(leaves.integrals), np.inf)
    return replace(leaves, error=np.minimum(leaves.error, only), noise=noise)


def split(f: Callable[[np.ndarray], np.ndarray], leaves: Leaves, chosen: np.ndarray) -> Leaves:
    """Return the leaves with the chosen ones (indices) halved along their worst axis, as far as floating point allows."""
    axis = leaves.axis[chosen]
    middle = 0.5 * (leaves.low[chosen, axis] + leaves.high[chosen, axis])
    possible = (middle > leaves.low[chosen, axis]) & (middle < leaves.high[chosen, axis])
    chosen, axis, middle = chosen[possible], axis[possible], middle[possible]
    if len(chosen) == 0:
        return leaves
    rows = np.arange(len(chosen))
    first_high, second_low = leaves.high[chosen], leaves.low[chosen]
    first_high[rows, axis] = middle
    second_low[rows, axis] = middle
    low = np.concatenate([leaves.low[chosen], second_low])
    high = np.concatenate([first_high, leaves.high[chosen]])
    return replaced(f, leaves, chosen, low, high)


def replaced(
    f: Callable[[np.ndarray], np.ndarray],
    leaves: Leaves,
    chosen: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
) -> Leaves:
    """Return the leaves with the chosen ones (indices) replaced by boxes (q, k) that fill the same region."""
    keep = np.ones(len(leaves.low), dtype=bool)
    keep[chosen] = False
    return leaves.chosen(keep).joined(evaluate(f, low, high))


def evaluate(f: Callable[[np.ndarray], np.ndarray], low: np.ndarray, high: np.ndarray) -> Leaves:
    """Apply both rules to each box once."""
    k = low.shape[1]
    per_block = max(1, _BLOCK // 15**k)
    parts = [_rule(f, low[i : i + per_block], high[i : i + per_block]) for i in range(0, len(low), per_block)]
    values, error, axis = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Leaves(low, high, values, error, axis, len(low) * 15**k)


def _rule(
    f: Callable[[np.ndarray], np.ndarray], low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    m, k = low.shape
    half = 0.5 * (high - low)
    axes = 0.5 * (low + high)[:, :, None] + half[:, :, None] * NODES  # (m, k, 15)
    volume = np.prod(half, axis=1)
    if k == 1:
        values, unknown = _sane(f(axes.reshape(-1, 1)).reshape(m, 15))
        kronrod, absolute = values @ KRONROD, np.abs(values) @ KRONROD
        scale = np.abs(values - 0.5 * kronrod[:, None]) @ KRONROD
        differences = np.abs(kronrod - values @ GAUSS)[:, None]
    else:
        grid = np.empty((m, 15, 15, 2))
        grid[..., 0], grid[..., 1] = axes[:, 0, :, None], axes[:, 1, None, :]
        values, unknown = _sane(f(grid.reshape(-1, 2)).reshape(m, 15, 15))
        along_second = values @ KRONROD
        kronrod, absolute = along_second @ KRONROD, (np.abs(values) @ KRONROD) @ KRONROD
        scale = (np.abs(values - 0.25 * kronrod[:, None, None]) @ KRONROD) @ KRONROD
        second = np.abs(kronrod - (values @ GAUSS) @ KRONROD)
        differences = np.stack([np.abs(kronrod - along_second @ GAUSS), second], axis=-1)
    raw = differences.sum(axis=-1)
    ratio = np.divide(200 * raw, scale, out=np.zeros_like(raw), where=scale > 0)
    error = np.where(ratio < 1, scale * ratio**1.5, 4 * raw) + _ROUNDING * absolute
    # A NaN or infinity must not pass for an accurate value. A box too small to be halved is an end of the domain, or a pole that
    # numbers are too coarse for: what is nearer than its nodes they have not seen.
    known = _smallest(low, high) & (absolute > 0)
    error = np.where(known, 8 * absolute, np.where(unknown, np.inf, error)) * volume
    return values, error, np.argmax(differences, axis=-1)


def _smallest(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return (m,) which boxes are only a few floating-point numbers wide."""
    return np.any(high - low <= 8 * np.spacing(np.maximum(np.abs(low), np.abs(high))), axis=1)


def _sane(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return values with the largest finite one of its box in place of each that is not finite, and (m,) where that was done."""
    finite = np.isfinite(values)
    unknown = ~finite.reshape(len(values), -1).all(axis=1)
    if not unknown.any():
        return values, unknown
    largest = np.where(finite, values, 0.0).reshape(len(values), -1).max(axis=1)
    return np.where(finite, values, largest.reshape(-1, *[1] * (values.ndim - 1))), unknown
