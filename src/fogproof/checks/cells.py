"""The cells that samples are counted in: edges from a pilot sample, expected masses by quadrature or from a given cdf."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from fogproof.checks.charts import Chart
from fogproof.checks.quadrature import integrate_boxes

_QUANTILES = {1: (1024,), 2: (48, 12)}
_UNIFORM = {1: (32,), 2: (16, 8)}
_COUNT_PER_CELL = 64  # samples expected in a cell, at least, on average


@dataclass(frozen=True)
class Cells:
    """A grid of cells in chart coordinates with the probability of each.

    edges       per axis, increasing, from end to end of the chart
    labels      what the axes are called
    mass        (cells…) probability of the continuous part in each cell
    mass_error  (cells…) bound on its error
    total       integral of the pdf over the whole domain
    total_error bound on its error
    evaluations of the pdf that it took
    complete    True if every point of the domain has a cell of its own
    """

    edges: tuple[np.ndarray, ...]
    labels: tuple[str, ...]
    mass: np.ndarray
    mass_error: np.ndarray
    total: float
    total_error: float
    evaluations: int
    complete: bool = False

    @property
    def gap(self) -> float:
        """The largest probability between neighbouring edges of a line: 0 where the edges separate all its points."""
        return 0.0 if self.complete else float(np.max(self.mass, initial=0.0))

    def count(self, coordinates: np.ndarray) -> np.ndarray:
        """Return (cells…) how many of the (n, k) coordinates fall in each cell."""
        flat = np.zeros(len(coordinates), dtype=np.intp)
        for axis, edges in enumerate(self.edges):
            index = np.searchsorted(edges, coordinates[:, axis], side="right") - 1
            flat = flat * (len(edges) - 1) + np.clip(index, 0, len(edges) - 2)
        return np.bincount(flat, minlength=self.mass.size).reshape(self.mass.shape)


def pilot_edges(chart: Chart, pilot: np.ndarray, samples: int, breaks: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return edges at quantiles of the pilot's (m, k) coordinates: about equal counts, never from the tested sample.

    A few edges at equal distances are added: they see what the pilot of a wrong sampler never visits. `breaks` (b, k) are edges
    too, so that no cell has a jump inside.
    """
    dimensions = len(chart.low)
    quantiles, uniform = np.array(_QUANTILES[dimensions]), np.array(_UNIFORM[dimensions])
    while (quantiles + uniform).prod() * _COUNT_PER_CELL > samples and quantiles.max() > 4:
        quantiles, uniform = np.maximum(quantiles // 2, 4), np.maximum(uniform // 2, 2)
    edges = []
    for axis in range(dimensions):
        low, high = chart.low[axis], chart.high[axis]
        shares = np.arange(1, quantiles[axis]) / quantiles[axis]
        inner = np.quantile(pilot[:, axis], shares) if len(pilot) else np.empty(0)
        inner = inner[(inner > low) & (inner < high)]
        jumps = breaks[:, axis][(breaks[:, axis] > low) & (breaks[:, axis] < high)]
        edges.append(np.unique(np.concatenate([inner, jumps, np.linspace(low, high, uniform[axis] + 1)])))
    return tuple(edges)


def cells_by_quadrature(
    density: Callable[[np.ndarray], np.ndarray],
    edges: tuple[np.ndarray, ...],
    labels: tuple[str, ...],
    tolerance: float,
    budget: int,
) -> Cells:
    """Integrate a density over chart coordinates, (m, k) -> (m,), in every cell."""
    shape = tuple(len(e) - 1 for e in edges)
    low, high = corners(edges)
    result = integrate_boxes(density, low, high, tolerance, budget)
    return Cells(
        edges,
        labels,
        result.value.reshape(shape),
        result.error.reshape(shape),
        result.total,
        result.total_error,
        result.evaluations,
    )


def corners(edges: tuple[np.ndarray, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Return the (m, k) lower and upper corners of all cells of a grid, the last axis running fastest."""
    low, high = (np.meshgrid(*ends, indexing="ij") for ends in ([e[:-1] for e in edges], [e[1:] for e in edges]))
    return tuple(np.stack([g.ravel() for g in grid], axis=-1) for grid in (low, high))  # type: ignore[return-value]


def unit_square_cells(cells: Cells) -> Cells:
    """Return as many equal cells of the unit square: the image of a right sampler's points under its Rosenblatt map."""
    edges = tuple(np.linspace(0, 1, len(e)) for e in cells.edges)
    mass = np.full(cells.mass.shape, 1 / cells.mass.size)
    labels = tuple(f"cdf of {label}" for label in cells.labels)
    return Cells(edges, labels, mass, np.zeros_like(mass), cells.total, cells.total_error, cells.evaluations)


def masses_from_cdf(cdf_at_edges: np.ndarray, edge_points: np.ndarray, atoms: Mapping[float, float]) -> np.ndarray:
    """Return (cells,) masses of the continuous part between edges of one axis, from a right-continuous cdf.

    cdf_at_edges  (cells + 1,) the cdf, atoms included
    edge_points   (cells + 1,) where it was evaluated
    """
    mass = np.diff(cdf_at_edges)
    for point, probability in atoms.items():
        inside = (edge_points[:-1] < point) & (point <= edge_points[1:])
        mass = mass - np.where(inside, probability, 0.0)
    return mass
