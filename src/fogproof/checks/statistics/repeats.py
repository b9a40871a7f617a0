"""Repeated points: a sampler of a density repeats itself as rarely as floating point allows.

The expected number of repetitions among n points is about n^2/2 E[p cell], with `cell` the volume of points that round to the same
one; with the uniforms' own repetitions and the rounding inside a sampler it is some times larger, in single precision large. What
lies beyond that is an undeclared atom, a generator of few values, or a stream that starts again.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fogproof.checks.statistics.tails import poisson_at_least
from fogproof.checks.subject import Precision
from fogproof.checks.verdict import Finding, Outcome
from fogproof.domains import Domain, UnitHemisphere, UnitSphere

KEPT = 1 << 18
"""Most points whose fingerprints are kept."""

_SLACK = 8.0  # how much coarser than the result the numbers inside a sampler may be
_UNIFORM: dict[Precision, float] = {"float64": 2.0**-53, "float32": 2.0**-24}
_MIX = (np.uint64(0x9E3779B97F4A7C15), np.uint64(0xC2B2AE3D27D4EB4F), np.uint64(0x165667B19E3779F9))


def fingerprints(x: np.ndarray) -> np.ndarray:
    """Return (n,) uint64: equal points have equal ones, different points different ones but for a chance of n^2 / 2^65."""
    columns = np.ascontiguousarray(np.atleast_2d(x.T) + 0.0).view(np.uint64)  # adding 0 turns -0 into 0
    total = np.zeros(columns.shape[1], dtype=np.uint64)
    with np.errstate(over="ignore"):
        for column, factor in zip(columns, _MIX, strict=False):
            mixed = (column ^ (column >> np.uint64(32))) * factor
            total = (total ^ (mixed >> np.uint64(29))) * factor + mixed
        return total ^ (total >> np.uint64(31))


def repeated(prints: np.ndarray) -> int:
    """Return how many of the fingerprints have occurred before: n less the number of different ones.

    Rounds of a hash table without collision chains: whoever is written last into a slot stands for it, equal ones are counted, and
    the others try again with other bits.
    """
    count = 0
    shift = 0
    while len(prints) > 1024:
        bits = len(prints).bit_length() + 1
        slot = ((prints >> np.uint64(shift)) & np.uint64((1 << bits) - 1)).astype(np.intp)
        holder = np.empty(1 << bits, dtype=np.int32)
        holder[slot] = np.arange(len(prints), dtype=np.int32)
        held = holder[slot]
        equal = prints[held] == prints
        own = held == np.arange(len(prints))
        count += int(np.count_nonzero(equal & ~own))
        prints = prints[~equal]
        shift = (shift + 17) % 40
    return count + len(prints) - len(np.unique(prints))


def expected_repeats(
    n: int, domain: Domain, precision: Precision, points: np.ndarray, density: np.ndarray, pole_mass: float
) -> float:
    """Return about how many repetitions a right sampler may show among n points.

    points, density  a pilot sample (q, ...) and the claimed density there (q,)
    pole_mass        probability of the points so near a pole that rounding can merge them all
    """
    roundoff = 0.5 * _UNIFORM[precision] if precision == "float64" else _UNIFORM[precision]
    pairs = 0.5 * n * n
    if len(points) == 0:
        return 0.0
    if points.ndim == 1:
        cell = 4 * roundoff * (np.abs(points) + np.median(np.abs(points)))
        uniforms = _UNIFORM[precision]
    else:
        turn = 2 * np.pi if isinstance(domain, (UnitSphere, UnitHemisphere)) else 1.0
        cell = np.full(len(points), 16 * roundoff**2 * turn)
        uniforms = 2.0**-48 if precision == "float32" else 2.0**-53
    return float(n * pole_mass + pairs * (uniforms + np.mean(np.minimum(density * cell, 1.0))))


def repeats_test(name: str, prints: np.ndarray, expected: Callable[[int], float], alpha: float) -> Finding:
    """Test that there are no more repetitions than the float grid explains: a Poisson bound.

    prints    (n,) fingerprints
    expected  n -> about how many repetitions rounding explains
    """
    n, seen = len(prints), repeated(prints)
    allowed = _SLACK * expected(n)
    p = poisson_at_least(seen, max(allowed, 1e-300))
    outcome: Outcome = "rejected" if p <= alpha else "not rejected"
    message = f"{seen} of the first {n} points repeat an earlier one; rounding explains up to about {allowed:.2g}"
    effect = seen / max(n, 1)
    return Finding(name, outcome, message, p, alpha, False, seen, effect, cause="atom" if outcome == "rejected" else "")
