"""Regions of an image over which differences are pooled: each family cuts it another way."""

from __future__ import annotations

import numpy as np

LEAST = 144
"""Pixels of a region, at least: fewer tell nothing of a mean."""

MOST = 64
"""Regions of a family, at most."""


def families(reference: np.ndarray) -> dict[str, np.ndarray]:
    """Return family -> labels (rows, columns) of its regions; families of a single region are left out.

    reference  (rows, columns) brightness, which gives the regions of equal brightness
    """
    rows, columns = reference.shape
    y, x = np.mgrid[:rows, :columns]
    radius = np.hypot((y + 0.5) / rows - 0.5, (x + 0.5) / columns - 0.5)
    count = rows * columns // LEAST
    bands = max(1, min(16, count))
    side = max(1, int(min(np.sqrt(min(count, MOST)), 8)))
    made = {
        "tiles": _cut(y, rows, min(side, rows)) * side + _cut(x, columns, min(side, columns)),
        "rows": _cut(y, rows, min(bands, rows)),
        "columns": _cut(x, columns, min(bands, columns)),
        "rings": _quantiles(radius, min(bands, 8)),
        "brightness": _quantiles(reference, min(bands, 8)),
    }
    return {name: labels for name, labels in made.items() if len(np.unique(labels)) > 1}


def _cut(index: np.ndarray, length: int, parts: int) -> np.ndarray:
    return index * parts // length


def _quantiles(value: np.ndarray, parts: int) -> np.ndarray:
    """Return which of so many equally large parts each pixel is in, by its value; equal values stay together."""
    finite = np.where(np.isfinite(value), value, 0.0)
    edges = np.unique(np.quantile(finite, np.linspace(0, 1, parts + 1)[1:-1]))
    labels: np.ndarray = np.searchsorted(edges, finite, side="right")
    return labels
