"""Scans: is there anywhere a place with too many or too few samples?

Every interval of 1, 2, 4, ... cells that starts at a multiple of half its length is an exact binomial test, and each length has
the same share of the false-alarm probability (a Bonferroni bound over all intervals). Skipped bands, atoms and lost tails are
found at the length that fits them, with their place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fogproof.checks.density.grid import GridPlane, Marginal
from fogproof.checks.statistics.binomial import binomial_p
from fogproof.checks.statistics.cells import MISS, between, blocks, nothing_counted
from fogproof.checks.statistics.chi_square import deviances
from fogproof.checks.statistics.tails import binomial_interval
from fogproof.checks.verdict import EffectInterval, Finding, Resolution

_SKIPPED = 0.5  # of the expected number of samples: a place with fewer is one that is avoided
_NARROW = 64  # cells: where there are fewer, one that is too full is no point


@dataclass(frozen=True)
class _Place:
    """One interval or cell: its p-value with the number of its rivals counted, what was seen, and what was expected."""

    p: float
    first: int
    last: int
    observed: int
    probability: float

    def beats(self, other: _Place, n: int) -> bool:
        """Whether this place is the more conspicuous one; where both p-values are 0, by how much there is too many or too few."""
        if self.p != other.p:
            return self.p < other.p
        return abs(self.observed - n * self.probability) > abs(other.observed - n * other.probability)


def scan(name: str, marginal: Marginal, counts: np.ndarray, alpha: float) -> Finding:
    """Look for a crowded or empty interval along one axis, counts (m,)."""
    n = int(counts.sum())
    if n == 0:
        return nothing_counted(name, alpha)
    total = np.concatenate([[0], np.cumsum(counts)])
    lengths = [1 << k for k in range(max(len(counts).bit_length() - 2, 1))]
    best = _Place(1.0, 0, len(counts), n, 1.0)
    for length in lengths:
        start = np.arange(0, len(counts) - length + 1, max(length // 2, 1))
        observed = total[start + length] - total[start]
        low, high = marginal.cdf[start], marginal.cdf[start + length]
        slack = marginal.doubt(start, start + length) + marginal.blur[start] + marginal.blur[start + length]
        i = _conspicuous(observed, n * (high - low), n * slack)
        mass = float(high[i] - low[i])
        p = binomial_p(int(observed[i]), n, mass - slack[i], mass + slack[i]) * len(start) * len(lengths)
        place = _Place(p, int(start[i]), int(start[i]) + length, int(observed[i]), mass)
        best = place if place.beats(best, n) else best
    rivals = 2 * len(counts) * len(lengths)
    unseen = 2 * float(np.max(marginal.error + marginal.blur))
    band = _smallest_band(n, alpha / rivals, len(counts)) + 3 * unseen
    resolution = Resolution(f"missing band in {marginal.label}", min(band, 1.0), MISS)
    return _finding(
        name, best, n, alpha, between(marginal, best.first, best.last), resolution, len(counts), not marginal.whole
    )


def scan_ends(
    name: str, marginal: Marginal, counts: np.ndarray, low: float, high: float, grain: float, alpha: float
) -> Finding:
    """Look at both ends of an axis: the samples in its first and last 1, 2, 4, ... cells, and the extreme samples themselves.

    low, high  smallest and largest counted coordinate. With u the cdf there, P(U_min > u) = (1 - u)^n exactly.
    grain      step of the sampler's uniforms: 0 itself comes with that probability
    """
    n = int(counts.sum())
    if n == 0:
        return nothing_counted(name, alpha)
    at = np.clip(marginal.at(np.array([low, high])), 0, 1)
    cells = len(counts)
    lengths = [1 << k for k in range(max(cells.bit_length() - 2, 1))]
    tries = 2 * (len(lengths) + 1)
    total = np.concatenate([[0], np.cumsum(counts)])
    best, what = _Place(1.0, 0, cells, n, 1.0), between(marginal, 0, cells)
    for first, last in [(0, k) for k in lengths] + [(cells - k, cells) for k in lengths]:
        mass = float(marginal.cdf[last] - marginal.cdf[first])
        edge = last if first == 0 else first
        slack = marginal.error[edge] + marginal.blur[edge]
        observed = int(total[last] - total[first])
        p = binomial_p(observed, n, mass - slack, mass + slack) * tries
        if p < best.p:
            best, what = _Place(p, first, last, observed, mass), between(marginal, first, last)
    for share, side, cell in ((float(at[0]), 0, 0), (float(1 - at[1]), -1, cells - 1)):
        doubt = marginal.error[1 if side == 0 else -2] + marginal.blur[1 if side == 0 else -2] + grain
        p = tries * _extreme_p(share, doubt, n)
        if p < best.p:
            where = f"the extreme sample, beyond which the pdf puts a probability of {share:.3g}"
            best, what = _Place(p, cell, cell + 1, 0 if n * share > 1 else 1, share), where
    resolution = Resolution(f"tail missing at an end of {marginal.label}", math.log(2 * tries / alpha) / n, MISS)
    finding = _finding(name, best, n, alpha, what, resolution, cells, False)
    if finding.outcome == "rejected" and best.observed == 0:
        return finding.because("missing tail")
    return finding


def _extreme_p(share: float, doubt: float, n: int) -> float:
    """Return the two-sided p-value of the smallest of n uniform numbers being `share`, known to within `doubt`."""
    larger = math.exp(n * math.log1p(-min(max(share - doubt, 0.0), 1 - 1e-16)))
    smaller = -math.expm1(n * math.log1p(-min(share + doubt, 1 - 1e-16)))
    return min(1.0, 2 * min(larger, smaller))


def scan_plane(name: str, labels: tuple[str, str], plane: GridPlane, counts: np.ndarray, alpha: float) -> Finding:
    """Look for a crowded or empty patch: squares of 1, 2, 4, ... cells of the plane, counts (size, size).

    The finer squares are only looked at where the axes are independent, for only then are their probabilities known.
    """
    n = int(counts.sum())
    if n == 0:
        return nothing_counted(name, alpha)
    finest = len(counts) if plane.independent else len(plane.mass)
    sizes = [finest >> level for level in range(finest.bit_length() - 2)]
    best, where, size = _Place(1.0, 0, 1, n, 1.0), (0, 0), 1
    for cells in sizes:
        observed = blocks(counts, cells)
        probability, slack = _claimed(plane, cells)
        o, q, e = observed.ravel(), probability.ravel(), slack.ravel()
        i = _conspicuous(o, n * q, n * e)
        p = binomial_p(int(o[i]), n, q[i] - e[i], q[i] + e[i]) * len(o) * len(sizes)
        if p < best.p:
            best, where, size = _Place(p, 0, 1, int(o[i]), float(q[i])), divmod(i, cells), cells
    resolution = Resolution(
        "missing patch (of equal shares of both axes)",
        4 * _smallest_band(n, alpha / (finest**2 * len(sizes)), finest**2),
        MISS,
    )
    place = " and ".join(
        f"share {k / size:.4g} to {(k + 1) / size:.4g} of {label}" for k, label in zip(where, labels, strict=True)
    )
    return _finding(name, best, n, alpha, place, resolution, finest**2, False)


def _claimed(plane: GridPlane, cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the probabilities (cells, cells) of squares of the plane, and bounds on their errors."""
    if plane.independent:
        first, second = (share.reshape(cells, -1).sum(axis=1) for share in plane.shares)
        return first[:, None] * second, plane.blur(cells)
    return blocks(plane.mass, cells), blocks(plane.error, cells) + plane.blur(cells)


def _conspicuous(observed: np.ndarray, expected: np.ndarray, slack: np.ndarray) -> int:
    """Return the index of the most conspicuous count, by Poisson deviance: its p-value is about the smallest, never less."""
    kind = np.clip(observed, expected - slack, expected + slack)
    return int(np.argmax(deviances(observed, kind)))


def _smallest_band(n: int, p: float, cells: int) -> float:
    """Return the mass of a missing band that is found for sure: a third of it at least is an interval, which is then empty."""
    return 3 * max((math.log(2 / p) + 1) / n, 1 / cells)


def _finding(
    name: str, best: _Place, n: int, alpha: float, where: str, resolution: Resolution, cells: int, atoms: bool
) -> Finding:
    p = min(best.p, 1.0)
    rejected = p <= alpha
    share = best.observed / n
    direction = "more" if share > best.probability else "fewer"
    message = (
        f"the most conspicuous place is {where}: {best.observed} samples where {n * best.probability:.4g} are expected"
    )
    if not rejected:
        message = f"no place has too many or too few samples; {message}"
    cause = ""
    if rejected:
        cause = "skipped band" if best.observed < _SKIPPED * n * best.probability else "shape"
        narrow = best.last - best.first == 1 and cells * best.probability < 4 and cells >= _NARROW
        if atoms and direction == "more" and narrow:
            cause = "atom"
    low, high = binomial_interval(best.observed, n, MISS)
    return Finding(
        name,
        "rejected" if rejected else "not rejected",
        message,
        p,
        alpha,
        False,
        best.observed,
        share - best.probability,
        resolution,
        interval=EffectInterval(low - best.probability, high - best.probability, 1 - MISS),
        region=(where,) if rejected else (),
        cause=cause,
    )
