"""What another test is: where it applies, and its p-value for a sampler."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.catalogue.cases import points_of


@dataclass(frozen=True)
class OtherTest:
    """One test.

    name, title, source   of it
    alpha     at which it is used where it comes from; a subject is rejected at p < alpha
    samples   that it draws
    applies   sampler -> whether it is made for such a domain
    p_value   (sampler, generator) -> its p-value
    """

    name: str
    title: str
    source: str
    alpha: float
    samples: int
    applies: Callable[[Any], bool]
    p_value: Callable[[Any, np.random.Generator], float]


def drawn(sampler: Any, rng: np.random.Generator, n: int, block: int = 1 << 16) -> np.ndarray:
    """Return n points, (n,) or (n, k), drawn in blocks."""
    parts = []
    for start in range(0, n, block):
        size = min(block, n - start)
        given = (rng, size) if sampler.dimensions is None else (rng.random((size, sampler.dimensions)),)
        parts.append(np.asarray(points_of(sampler.sample(*given)), dtype=float))
    return np.concatenate(parts)


def several_runs(alpha: float, runs: int) -> float:
    """Return the level of one of several runs that share a level (Šidák 1967)."""
    return 1 - (1 - alpha) ** (1 / runs)
