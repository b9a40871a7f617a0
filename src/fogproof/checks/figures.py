"""Data for plots of a verdict: the shares of the bins of a line, or the signed misfit of the cells of a plane."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.checks.density.grid import GridPlane, Marginal
from fogproof.checks.json_values import jsonable

_BINS = 64


def bins_figure(marginal: Marginal, counts: np.ndarray) -> dict[str, Any]:
    """Return expected and observed shares of at most 64 bins of equal probability, and their signed z."""
    at = np.unique(np.arange(_BINS + 1) * len(counts) // _BINS)
    n = max(int(counts.sum()), 1)
    expected, observed = np.diff(marginal.cdf[at]), np.add.reduceat(counts, at[:-1]) / n
    z = (observed - expected) * np.sqrt(n / np.maximum(expected, 1e-300))
    edges = marginal.shown[at]
    if edges[-1] < edges[0]:
        edges, expected, observed, z = edges[::-1], expected[::-1], observed[::-1], z[::-1]
    figure = {"kind": "bins", "label": marginal.label, "edges": edges, "expected": expected, "observed": observed}
    return jsonable({**figure, "z": np.round(z, 2)})


def z_map_figure(marginals: tuple[Marginal, Marginal], plane: GridPlane, counts: np.ndarray) -> dict[str, Any]:
    """Return (observed - expected) / sigma of the coarse cells of a plane, counts (32, 32)."""
    n = counts.sum()
    expected = n * plane.mass
    z = (counts - expected) / np.sqrt(np.maximum(expected, 1.0))
    edges = []
    for axis, (marginal, rows) in enumerate(zip(marginals, plane.rows, strict=True)):
        coarse = rows * len(plane.mass) // plane.size
        shown = marginal.shown[np.append(np.searchsorted(coarse, np.arange(len(plane.mass))), len(rows))]
        if shown[-1] < shown[0]:
            shown, z = shown[::-1], np.flip(z, axis)
        edges.append(shown)
    labels = [marginal.label for marginal in marginals]
    return jsonable({"kind": "z-map", "labels": labels, "edges": edges, "z": np.round(z, 2)})
