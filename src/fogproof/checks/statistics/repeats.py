"""Repeated points: a sampler of a density repeats itself as rarely as floating point allows.

The expected number of repetitions among n points is about n^2/2 E[p cell], with `cell` the volume of points that round to the same
one; with the uniforms' own repetitions and the rounding inside a sampler it is some times larger, in single precision large. What
lies beyond that is an undeclared atom, a generator of few values, or a stream that starts again.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.tails import binomial_at_most, normal_quantile, poisson_at_least
from fogproof.checks.subject import Precision
from fogproof.checks.verdict import Finding, Resolution
from fogproof.domains import Domain, UnitHemisphere, UnitSphere

KEPT = 1 << 18
"""Most points whose fingerprints are kept."""

_WINDOW = 32  # neighbours on either side that tell how far apart values are
_EQUAL = 1e-6  # of that distance
_SAME = 1e-13  # of the span of all values
_OFTEN = 8  # samples of a single number
_SEVERAL = 8  # such numbers
_NEARLY_ALL = 0.9  # of all samples have one of them
_APART = 1e3  # times what rounding does: single numbers, and none of its own steps
_CERTAIN = 0.999

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
    n: int,
    domain: Domain,
    precision: Precision,
    points: np.ndarray,
    density: np.ndarray,
    pole_mass: float,
    bits: int | None = None,
) -> float:
    """Return about how many repetitions a right sampler may show among n points.

    points, density  a pilot sample (q, ...) and the claimed density there (q,)
    pole_mass        probability of the points so near a pole that rounding can merge them all
    bits             of the sampler's uniforms, if they are declared
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
        steps = np.sort(np.maximum(np.abs(points), 1.0), axis=1)[:, -2:]  # far from the origin numbers are coarser
        cell = 16 * roundoff**2 * turn * np.prod(steps, axis=1)
        uniforms = 2.0**-48 if precision == "float32" else 2.0**-53
    if bits is not None:
        uniforms = max(uniforms, 2.0 ** (-bits * min(2, points.ndim)))
    return float(n * pole_mass + pairs * (uniforms + np.mean(np.minimum(density * cell, 1.0))))


def repeats_test(name: str, prints: np.ndarray, expected: Callable[[int], float], alpha: float) -> Finding:
    """Test that there are no more repetitions than the float grid explains: a Poisson bound.

    prints    (n,) fingerprints, in the order in which the points were drawn
    expected  n -> about how many repetitions rounding explains
    """
    n, seen = len(prints), repeated(prints)
    allowed = min(n, _SLACK * expected(n))  # no more than all; a claim may be infinite, or not a number
    p = poisson_at_least(seen, max(allowed, 1e-300))
    message = f"{seen} of the first {n} points repeat an earlier one; rounding explains up to about {allowed:.2g}"
    resolution = _less_than_all("probability of an undeclared atom", _smallest_atom(n, allowed, alpha))
    if p > alpha:
        return Finding(name, "not rejected", message, p, alpha, False, seen, seen / max(n, 1), resolution)
    kind, cause = _kind_of_repetition(prints)
    return Finding(name, "rejected", f"{message}: {kind}", p, alpha, False, seen, seen / n, resolution, cause=cause)


def _fewest(n: int, allowed: float, alpha: float) -> float:
    """Return the probability of each of some equally likely values whose repetitions are noticed, but for `MISS`.

    Among n values, 1 / p of them different at most, about n^2 p / 2 repeat an earlier one, as often as a Poisson number, or less
    scattered.
    """
    least, z = _noticed(allowed, alpha), normal_quantile(MISS)
    wanted = (0.5 * z + math.sqrt(0.25 * z * z + least)) ** 2 + 1
    low, high = 0.0, 1.0
    for _ in range(60):  # n - E[different ones], with (1 - exp(-n p)) / p different ones
        p = 0.5 * (low + high)
        low, high = (p, high) if n + math.expm1(-n * p) / p < wanted else (low, p)
    return high


def _less_than_all(kind: str, probability: float) -> Resolution | None:
    """Return a resolution, None where not even a certainty would be noticed."""
    return Resolution(kind, probability, MISS) if probability < _CERTAIN else None


def _noticed(allowed: float, alpha: float) -> int:
    """Return a number of repetitions that is rejected where about `allowed` are explained."""
    least = 1
    while poisson_at_least(least, max(allowed, 1e-300)) > alpha:
        least = max(least + 1, int(1.05 * least))
    return least


def _smallest_atom(n: int, allowed: float, alpha: float) -> float:
    """Return the probability of a point whose repetitions among n points are more than `allowed` explains, but for `MISS`."""
    least = _noticed(allowed, alpha)
    low, high = 0.0, 1.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if binomial_at_most(least, n, middle) > MISS else (low, middle)
    return high


def _kind_of_repetition(prints: np.ndarray) -> tuple[str, str]:
    """Return in words how points repeat, and the cause that this points to."""
    values, inverse, counts = np.unique(prints, return_inverse=True, return_counts=True)
    extra, n = len(prints) - len(values), len(prints)
    often = int(counts.max()) - 1
    if often >= 0.5 * extra and (
        often > 1 or extra == 1
    ):  # several points that each come twice are none that comes often
        return f"one point comes {often + 1} times", "atom"
    order = np.argsort(inverse, kind="stable")
    again = np.diff(inverse[order]) == 0
    apart = np.diff(order)[again]
    distances, times = np.unique(apart, return_counts=True)
    if times.max() >= 0.5 * extra and extra >= 0.01 * n:
        far = int(distances[np.argmax(times)])
        where = "right after the first time" if far == 1 else f"{far} points later"
        return f"a share of {times.max() / n:.2g} comes again {where}", "repeated samples"
    several = int(np.count_nonzero(counts > 1))
    if counts.mean() > 1.5 or extra < 2 * several:
        return f"there are {len(values)} different points among {n}: numbers of few bits", "coarse numbers"
    return f"{several} points come {extra / several + 1:.2g} times on average", "atom"


def _between_values(t: np.ndarray, rounding: float) -> np.ndarray:
    """Return how far apart sorted values (n,) are where they are several single numbers, each taken often; 0 where they are not.

    Neighbours that are all equal do not tell how far apart values are, the next number does. Fewer numbers may be lobes narrower
    than rounding, which are no fault.
    """
    grain = _SLACK * rounding + _SAME * float(t[-1] - t[0])
    last = np.append(np.flatnonzero(np.diff(t) > grain), len(t) - 1)
    first = np.append(0, last[:-1] + 1)
    count = last - first + 1
    before, after = np.append(first[:1], last[:-1]), np.append(first[1:], last[-1:])
    apart = 0.5 * (t[after] - t[before])
    single = (count >= _OFTEN) & (t[last] - t[first] <= grain) & (apart > _APART * grain)
    if np.count_nonzero(single) < _SEVERAL or count[single].sum() < _NEARLY_ALL * len(t):
        return np.zeros(len(t))
    return np.repeat(np.where(single, apart / count, 0.0), count)


def coarse_test(
    name: str, label: str, t: np.ndarray, rounding: float, bits: int, alpha: float, grid: bool = False
) -> Finding:
    """Test that one coordinate takes as many different values as its samples are: numbers of few bits do not.

    t         (n,) values of a coordinate whose law is continuous, in any unit; neighbours closer than 1e-6 of the spacing around
              them count as equal
    rounding  what rounding of the points can change about a value
    bits      of the uniforms that the sampler uses
    grid      whether the points may be those of a grid, of which many share a coordinate
    """
    n = len(t)
    if n < _WINDOW * 4:
        return Finding(name, "not rejected", "too few samples to see numbers of few bits", 1.0, alpha)
    t = np.sort(t)
    gap = np.diff(t)
    ends = np.clip(np.arange(n - 1)[:, None] + (-_WINDOW, _WINDOW), 0, n - 1)
    spacing = (t[ends[:, 1]] - t[ends[:, 0]]) / (ends[:, 1] - ends[:, 0])
    if not grid:
        spacing = np.maximum(spacing, _between_values(t, rounding)[:-1])
    seen = int(np.count_nonzero(gap <= _EQUAL * spacing))
    with np.errstate(divide="ignore", invalid="ignore"):
        merged = np.where(spacing > 0, np.minimum(2 * rounding / spacing, 1.0), 1.0 if rounding > 0 else 0.0)
    allowed = _SLACK * (n * _EQUAL + float(np.sum(merged)) + 0.5 * n * n * 2.0**-bits)
    p = poisson_at_least(seen, allowed)
    different = n - seen
    kind = f"probability of each value of {label}, of a few equally likely ones,"
    resolution = _less_than_all(kind, _fewest(n, allowed, alpha))
    message = f"{different} of {n} values of {label} differ; rounding explains up to about {allowed:.2g} equal ones"
    if p > alpha:
        return Finding(name, "not rejected", message, p, alpha, False, seen, seen / n, resolution)
    values = f"{message}: {label} takes few values" if different < 0.9 * n else message
    return Finding(name, "rejected", values, p, alpha, False, seen, seen / n, resolution, cause="coarse numbers")
