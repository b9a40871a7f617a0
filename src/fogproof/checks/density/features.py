"""What quadrature may have missed, as the samples tell: densities that its polynomials do not know, and places left empty.

Every sample's density is compared with the range the polynomials have in its cell; the emptiest cells of a line are probed.
Where the density turns out to be different, the boxes are cut there and integrated again: nothing about the counts is changed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.checks.density.charts import Axis, Chart
from fogproof.checks.density.grid import GridPlane, Marginal
from fogproof.checks.density.model import Density
from fogproof.checks.density.quadrature import NODES, Leaves

_WIDER = 2.0  # the range in a cell is stretched by this factor: between its points a density may vary
_MOST = 1 << 12  # suspicious points kept
_EMPTIEST = 256  # cells probed, the largest of the emptiest
_PROBES = 32  # in each of them


@dataclass(frozen=True)
class Ranges:
    """The least and greatest density (m,) that the polynomials have in each cell."""

    least: np.ndarray
    greatest: np.ndarray

    def strange(self, cell: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Return (n,) which densities p (n,) do not belong in their cells (n,)."""
        return (p < self.least[cell]) | (p > self.greatest[cell])


def ranges_of_line(axis: Axis, marginal: Marginal, jacobian: Density, curve_density: Density) -> Ranges:
    """Return the ranges in the fine cells of a line, from both ends and the middle of each."""
    edges = axis.uncounted(marginal.edges)
    middles = 0.5 * (edges[:-1] + edges[1:])
    with np.errstate(all="ignore"):
        sides, inner = (curve_density(t) / jacobian(t[:, None]) for t in (edges, middles))
    columns = np.stack([sides[:-1], inner, sides[1:]])
    finite = np.isfinite(columns)
    least = np.where(finite, columns, 0.0).min(axis=0) / _WIDER
    greatest = np.where(finite, columns, np.inf).max(axis=0) * _WIDER
    for ends in (slice(1), slice(-1, None)):  # they may be singular
        least[ends], greatest[ends] = 0.0, np.inf
    return Ranges(least, greatest)


def ranges_of_plane(chart: Chart, leaves: Leaves, marginals: tuple[Marginal, ...], plane: GridPlane) -> Ranges:
    """Return the ranges in the coarse cells of a plane, from all nodes in them; where there is none, anything goes."""
    middle, half = 0.5 * (leaves.low + leaves.high), 0.5 * (leaves.high - leaves.low)
    at = middle[:, :, None] + half[:, :, None] * NODES
    first, second = np.broadcast_arrays(at[:, 0, :, None], at[:, 1, None, :])
    points = np.stack([first.ravel(), second.ravel()], axis=-1)
    with np.errstate(all="ignore"):
        p = leaves.values.ravel() / chart.jacobian(points)
    size = len(plane.mass)
    cell = np.zeros(len(points), dtype=np.intp)
    for k, (axis, marginal, rows) in enumerate(zip(chart.axes, marginals, plane.rows, strict=True)):
        cell = cell * size + rows[marginal.lookup(axis.counted(points[:, k]))] * size // plane.size
    least, greatest, nodes = np.full(size * size, np.inf), np.zeros(size * size), np.bincount(cell, minlength=size**2)
    np.minimum.at(least, cell, np.where(np.isfinite(p), p, 0.0))
    np.maximum.at(greatest, cell, np.where(np.isfinite(p), p, np.inf))
    few = nodes < 9
    return Ranges(np.where(few, 0.0, least / _WIDER**2), np.where(few, np.inf, greatest * _WIDER**2))


def kept(points: np.ndarray, more: np.ndarray) -> np.ndarray:
    """Return suspicious points together, as many as are kept."""
    return np.concatenate([points, more])[:_MOST] if len(more) else points


def emptiest(axis: Axis, marginal: Marginal, counts: np.ndarray) -> np.ndarray:
    """Return coordinates (q,) inside the cells of a line that have the fewest samples for their probability."""
    expected = counts.sum() * marginal.mass
    lack = (counts - expected) / np.sqrt(np.maximum(expected, 1.0))
    few = np.flatnonzero(lack < -3.0)
    few = few[np.argsort(lack[few])][:_EMPTIEST]
    edges = axis.uncounted(marginal.edges)
    shares = (np.arange(_PROBES) + 0.5) / _PROBES
    return (edges[few, None] + (edges[few + 1] - edges[few])[:, None] * shares).ravel()
