"""A table of probabilities on whole numbers: every sum over it is exact.

Samples are counted twice: by number, and by how probable their number is. Numbers of equal weight stand side by side in the second
order, so that weights which belong to other entries show there, however many entries there are.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fogproof.checks.density.grid import Grid, Marginal
from fogproof.checks.density.lookup import Lookup
from fogproof.checks.subject import Subject


def table_grid(subject: Subject, n: int) -> tuple[Grid, Callable[[np.ndarray], tuple[np.ndarray, ...]]]:
    """Return the cells of the numbers 0 ... n - 1, in their own order and by probability, and how samples are counted in them."""
    mass = table(subject, n)
    by_number = _marginal("x", mass, subject.roundoff)
    order = np.argsort(mass, kind="stable")
    distinct = len(np.unique(mass))
    if distinct < 3:
        return Grid((by_number,), None), lambda x: (x,)
    rank = np.empty(n)
    rank[order] = np.arange(n)
    by_mass = _marginal("the order of p(x)", mass[order], subject.roundoff)
    return Grid((by_number, by_mass), None), lambda x: (x, rank[x.astype(np.intp)])


def table(subject: Subject, n: int) -> np.ndarray:
    """Return (n,) the claimed probabilities, those that are none as 0."""
    mass = subject.density(np.arange(n, dtype=np.float64))
    return np.where(np.isfinite(mass) & (mass > 0), mass, 0.0)


def _marginal(label: str, mass: np.ndarray, roundoff: float) -> Marginal:
    n = len(mass)
    cdf = np.concatenate([[0.0], np.cumsum(mass)]) / (mass.sum() if mass.sum() > 0 else 1.0)
    edges = np.arange(n + 1) - 0.5
    error, none = np.full(n + 1, 4 * roundoff), np.zeros(n + 1)
    return Marginal(label, edges, edges, cdf, none, error, none, False, Lookup.of(edges), lambda x: x, True)
