"""The cells of a line by its given cdf, of the unit cube under a given map, and those that only put places in order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fogproof.checks.density.grid import COARSE, FINEST_PLANE, Grid, GridPlane, Marginal, cells_wanted
from fogproof.checks.density.lookup import Lookup

_LAST_PLACES = 16  # units in the last place that a given map may be off
_REGIONS = 64  # cells of a pilot along each axis


def line_grid_from_cdf(grid: Grid, cdf_at: Callable[[np.ndarray], np.ndarray], slack: float) -> Grid:
    """Return the cells of a line with the probabilities that a given cdf of the continuous part says, (m,) -> (m,)."""
    (marginal,) = grid.marginals
    values = cdf_at(marginal.edges)
    first, total = values[0], values[-1] - values[0]
    total = total if total > 0 else 1.0

    def at(counted: np.ndarray) -> np.ndarray:
        return (cdf_at(counted) - first) / total

    error = np.full_like(values, slack)
    none = np.zeros_like(values)
    return Grid((replace(marginal, cdf=(values - first) / total, before=none, at_edge=error, at=at),), None)


def pilot_grid(labels: tuple[str, ...], u: np.ndarray) -> Grid:
    """Return cells that hold equal shares of pilot points u (n, k) along each axis: places in order, not known probabilities."""
    marginals = []
    for axis, label in enumerate(labels):
        inner = np.unique(u[:, axis])[:: max(len(u) // _REGIONS, 1)]
        edges = np.unique(np.concatenate([[0.0], inner[(inner > 0) & (inner < 1)], [1.0]]))
        share = np.interp(edges, np.sort(u[:, axis]), np.arange(len(u)) / len(u)) if len(u) else edges
        share[0], share[-1] = 0.0, 1.0
        unknown, none = np.full(len(edges), np.inf), np.zeros(len(edges))
        lookup = Lookup.of(edges)
        marginals.append(Marginal(label, edges, edges, share, unknown, none, none, False, lookup, lambda c: c))
    return Grid(tuple(marginals), None)


def unit_cube_grid(labels: tuple[str, ...], samples: int, roundoff: float) -> Grid:
    """Return the cells of the unit cube, where a right sampler's points are uniform under a given map.

    The map may be off by a few units in the last place, which moves samples across edges as rounding does.
    """
    cells = cells_wanted(samples, min(len(labels), 2))
    edges, slack = np.arange(cells + 1) / cells, max(_LAST_PLACES * roundoff, 1e-14)
    none, lookup = np.zeros(cells + 1), Lookup.of(edges)
    blur = np.full(cells + 1, slack)
    marginals = tuple(
        Marginal(label, edges, edges, edges, none, none, blur, True, lookup, lambda c: c) for label in labels
    )
    if len(labels) != 2:
        return Grid(marginals, None)
    size = 1 << int(np.clip(0.5 * np.log2(max(samples, 1) / 2), np.log2(COARSE), np.log2(FINEST_PLANE)))
    rows = (np.arange(cells) * size) // cells
    mass = np.full((COARSE, COARSE), COARSE**-2.0)
    share, along, across = np.full(size, 1 / size), np.full(size + 1, slack), np.full(size, 2 * slack / size)
    return Grid(marginals, GridPlane((rows, rows), (share, share), along, across, mass, np.zeros_like(mass), True))
