"""A phase function as a table that compiled kernels draw from, for kinds that have no closed form there.

The density is linear in each cell of the versine v = 1 - mu, with the cell's own probability, found by 16 Gauss-Legendre
nodes: so the distribution is right at every edge, and what is off in between averages out to second order. Cells are halved
where the line differs most from the density. Kernels draw from the table and take its density too, so that estimators are
unbiased for the tabulated phase function. It differs from the one asked for in no event by more than the half of `error` in
probability, 1e-6 where not even Lorenz-Mie needs too many cells, 1e-5 at most. A scattering order k sees k times that, far
below what 1e8 samples resolve (1e-4).
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fogproof.errors import UnsupportedError, shorten
from fogproof.estimators.kernels.path_data import TableLobe
from fogproof.estimators.phase.functions import density
from fogproof.scene.phase import PhaseFunction

ENOUGH = 1e-6
"""Integral of the absolute difference over the sphere with which refinement ends, or with so many cells:"""

MOST_CELLS = 1 << 17

TOO_MUCH = 1e-5
"""What is refused."""

INNERMOST = 1e-290
"""Versine below which a phase function that is infinite straight ahead is cut off."""

_x, _w = np.polynomial.legendre.leggauss(16)
NODES, WEIGHTS = (1 + _x) / 2, _w / 2


class Tabled(NamedTuple):
    """The table, and the integral over the sphere of what it is off; what the cells miss of 1 is divided out and counted."""

    lobe: TableLobe
    error: float


class _Cells(NamedTuple):
    """Edges (n,) as versines and coversines, integrals of the density and of what the line is off, and the line's two ends."""

    v0: np.ndarray
    v1: np.ndarray
    c0: np.ndarray
    c1: np.ndarray
    mass: np.ndarray
    off: np.ndarray
    left: np.ndarray
    right: np.ndarray


@lru_cache(maxsize=32)
def tabulated_lobe(phase: PhaseFunction) -> Tabled:
    """Return the table of a phase function."""
    v, c = _first_edges(phase)
    cells = _fit(phase, v[:-1], v[1:], c[:-1], c[1:])
    while (total := float(cells.off.sum())) > ENOUGH and len(cells.off) < MOST_CELLS:
        worst = cells.off > max(0.25 * float(cells.off.max()), 0.25 * total / len(cells.off))
        worst &= (cells.v1 - cells.v0) > 1e-14 * np.minimum(cells.v1, cells.c0)
        if not worst.any():
            break
        bad = _Cells(*(x[worst] for x in cells))
        near = bad.v0 < bad.c1  # the versine has the finer digits
        v = np.where(near, (bad.v0 + bad.v1) / 2, 2 - (bad.c0 + bad.c1) / 2)
        c = np.where(near, 2 - (bad.v0 + bad.v1) / 2, (bad.c0 + bad.c1) / 2)
        halves = _fit(phase, *(np.concatenate(x) for x in ((bad.v0, v), (v, bad.v1), (bad.c0, c), (c, bad.c1))))
        cells = _Cells(*(np.concatenate([x[~worst], y]) for x, y in zip(cells, halves, strict=True)))
    order = np.lexsort((-cells.c0, cells.v0))  # at the back versines are equal where coversines are not
    cells = _Cells(*(x[order] for x in cells))
    found = float(cells.mass.sum())
    total += abs(found - 1)
    if not total <= TOO_MUCH:
        cells_left = f"a table of {len(cells.off)} cells is off by {total:.2g}"
        raise UnsupportedError(f"{cells_left} of the phase function {shorten(phase)}", "phase")
    cdf = np.concatenate([[0.0], np.cumsum(cells.mass)]) / found
    cdf[-1] = 1.0
    edges = np.append(cells.v0, 2.0), np.append(cells.c0, 0.0)
    return Tabled(TableLobe(*edges, cdf, cells.left / found, cells.right / found), total)


def _first_edges(phase: PhaseFunction) -> tuple[np.ndarray, np.ndarray]:
    """Return versines and coversines of equal angles, and of octaves towards the poles until hardly anything is left there."""
    theta = np.linspace(0, np.pi / 2, 65)[1:]
    inner = 2 * np.sin(theta / 2) ** 2
    forward, backward = (np.concatenate([_octaves(phase, inner[0], mirrored), inner]) for mirrored in (False, True))
    v = np.concatenate([[0.0], forward, 2 - backward[-2::-1], [2.0]])
    c = np.concatenate([[2.0], 2 - forward, backward[-2::-1], [0.0]])
    return v, c


def _octaves(phase: PhaseFunction, start: float, mirrored: bool) -> np.ndarray:
    edges = start * 0.5 ** np.arange(1, 1000)
    edges = edges[edges > INNERMOST]
    value = density(phase, 2 - edges, edges) if mirrored else density(phase, edges, 2 - edges)
    matters = np.flatnonzero(2 * np.pi * edges * value > 1e-17)
    return edges[: matters[-1] + 2 if len(matters) else 1][::-1]


def _fit(phase: PhaseFunction, v0: np.ndarray, v1: np.ndarray, c0: np.ndarray, c1: np.ndarray) -> _Cells:
    """Return the cells between these edges: lines that have the probability of each, and rise as the density does."""
    width = np.where(v0 < c1, v1 - v0, c0 - c1)
    v, c = v0[:, None] + width[:, None] * NODES, c1[:, None] + width[:, None] * (1 - NODES)
    f = density(phase, v.ravel(), c.ravel()).reshape(v.shape)
    mean = f @ WEIGHTS
    rise = np.clip(12 * (f * (NODES - 0.5)) @ WEIGHTS, -2 * mean, 2 * mean)  # of the line nearest to f
    line = mean[:, None] + rise[:, None] * (NODES - 0.5)
    off = 2 * np.pi * width * (np.abs(f - line) @ WEIGHTS)
    return _Cells(v0, v1, c0, c1, 2 * np.pi * width * mean, off, mean - rise / 2, mean + rise / 2)
