"""A hard case: what the oracle said, and what is right."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np

from fogproof.contracts import Reference

DIGITS = 50


class Case(NamedTuple):
    """One value beside the truth, which is itself within `doubt` of what is right."""

    value: float
    error: float
    truth: mp.mpf
    doubt: mp.mpf
    given: str
    seconds: float


class Kind(NamedTuple):
    """A kind of case: draws one, and how many there are of it beside the others."""

    draw: Callable[[np.random.Generator], tuple[Reference, Any, Any, str]]
    share: float = 1.0


def number(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a number whose logarithm is uniform between those of low and high."""
    return float(10 ** rng.uniform(np.log10(low), np.log10(high)))


def albedo(rng: np.random.Generator) -> float:
    """Return an albedo: anywhere, close to 0 or to 1, or one of them."""
    return float(
        rng.choice(
            [rng.random(), number(rng, 1e-300, 1), 1 - number(rng, 1e-16, 1), 0.0, 1.0], p=[0.4, 0.2, 0.3, 0.05, 0.05]
        )
    )


def signed(rng: np.random.Generator, x: float) -> float:
    """Return x or -x."""
    return float(x * rng.choice([-1, 1]))


def anisotropy(rng: np.random.Generator) -> float:
    """Return a mean cosine that crowds towards 0 and +-1."""
    return signed(rng, float(rng.choice([rng.random(), number(rng, 1e-18, 1), 1 - number(rng, 1e-4, 1)])))
