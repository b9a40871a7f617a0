"""Adaptive Gauss-Kronrod quadrature over many boxes at once, in one or two dimensions, with an error bound for each.

Every box is evaluated at the 15 (or 15 x 15) Kronrod nodes; the difference from the embedded 7-point Gauss rule, sharpened as in
QUADPACK (Piessens et al. 1983, qk15), estimates its error. The worst boxes are halved, all of a round at once, until the sum of
the estimates is below the tolerance or the evaluations are used up. Whatever error is left is reported, never hidden.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

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


@dataclass(frozen=True)
class Integrals:
    """One integral a box: (m,) values and (m,) error bounds; `evaluations` of the integrand were spent."""

    value: np.ndarray
    error: np.ndarray
    evaluations: int

    @property
    def total(self) -> float:
        """The integral over all boxes."""
        return float(np.sum(self.value))

    @property
    def total_error(self) -> float:
        """Bound on the error of `total`."""
        return float(np.sum(self.error))


def integrate_boxes(
    f: Callable[[np.ndarray], np.ndarray], low: np.ndarray, high: np.ndarray, tolerance: float, budget: int
) -> Integrals:
    """Integrate f over m boxes.

    f          (q, k) coordinates -> (q,) values
    low, high  (m, k) corners, k = 1 or 2
    tolerance  wanted bound on the sum of the errors
    budget     most evaluations of f
    """
    owner = np.arange(len(low))
    value, error, worst_axis = _rule(f, low, high)
    evaluations = len(low) * 15 ** low.shape[1]
    while True:
        excess = error > tolerance / (2 * len(error))
        if error.sum() <= tolerance or not excess.any():
            break
        room = int((budget - evaluations) // (2 * 15 ** low.shape[1]))
        chosen = np.flatnonzero(excess)
        chosen = chosen[np.argsort(error[chosen])[::-1][: max(room, 0)]]
        axis = worst_axis[chosen]
        middle = 0.5 * (low[chosen, axis] + high[chosen, axis])
        chosen = chosen[(middle > low[chosen, axis]) & (middle < high[chosen, axis])]
        if len(chosen) == 0:
            break
        low, high, child_low, child_high = _halve(low, high, chosen, worst_axis[chosen])
        child_value, child_error, child_axis = _rule(f, child_low, child_high)
        evaluations += len(child_low) * 15 ** low.shape[1]
        keep = np.ones(len(owner), dtype=bool)
        keep[chosen] = False
        low, high = np.concatenate([low[keep], child_low]), np.concatenate([high[keep], child_high])
        value, error = np.concatenate([value[keep], child_value]), np.concatenate([error[keep], child_error])
        worst_axis = np.concatenate([worst_axis[keep], child_axis])
        owner = np.concatenate([owner[keep], owner[chosen], owner[chosen]])
    boxes = int(owner.max()) + 1
    return Integrals(np.bincount(owner, value, boxes), np.bincount(owner, error, boxes), evaluations)


def _halve(
    low: np.ndarray, high: np.ndarray, chosen: np.ndarray, axis: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    middle = 0.5 * (low[chosen, axis] + high[chosen, axis])
    rows = np.arange(len(chosen))
    first_high, second_low = high[chosen].copy(), low[chosen].copy()
    first_high[rows, axis] = middle
    second_low[rows, axis] = middle
    return low, high, np.concatenate([low[chosen], second_low]), np.concatenate([first_high, high[chosen]])


def _rule(
    f: Callable[[np.ndarray], np.ndarray], low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return value, error estimate and the axis to halve, for each box."""
    k = low.shape[1]
    per_block = max(1, _BLOCK // 15**k)
    parts = [_rule_block(f, low[i : i + per_block], high[i : i + per_block]) for i in range(0, len(low), per_block)]
    value, error, axis = (np.concatenate(column) for column in zip(*parts, strict=True))
    return value, error, axis


def _rule_block(
    f: Callable[[np.ndarray], np.ndarray], low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    m, k = low.shape
    half = 0.5 * (high - low)
    axes = 0.5 * (low + high)[:, :, None] + half[:, :, None] * NODES  # (m, k, 15)
    volume = np.prod(half, axis=1)
    if k == 1:
        values = f(axes.reshape(-1, 1)).reshape(m, 15)
        kronrod, absolute = values @ KRONROD, np.abs(values) @ KRONROD
        scale = np.abs(values - 0.5 * kronrod[:, None]) @ KRONROD
        differences = np.abs(kronrod - values @ GAUSS)[:, None]
    else:
        grid = np.stack(np.broadcast_arrays(axes[:, 0, :, None], axes[:, 1, None, :]), axis=-1)
        plane = f(grid.reshape(-1, 2)).reshape(m, 15, 15)
        along_y = plane @ KRONROD
        kronrod, absolute = along_y @ KRONROD, (np.abs(plane) @ KRONROD) @ KRONROD
        scale = (np.abs(plane - 0.25 * kronrod[:, None, None]) @ KRONROD) @ KRONROD
        differences = np.abs(np.stack([kronrod - along_y @ GAUSS, kronrod - (plane @ GAUSS) @ KRONROD], axis=-1))
    raw = differences.sum(axis=-1)
    ratio = np.divide(200 * raw, scale, out=np.zeros_like(raw), where=scale > 0)
    error = np.where(ratio < 1, scale * ratio**1.5, raw) + 50 * np.finfo(float).eps * absolute
    # A NaN or infinity in the integrand must not pass for an accurate value.
    error = np.where(np.isfinite(kronrod), error, np.inf)
    return kronrod * volume, error * volume, np.argmax(differences, axis=-1)
