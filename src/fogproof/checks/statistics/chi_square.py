"""The likelihood-ratio test of counts against the cells' probabilities, along an axis and on the coarse plane."""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.density.grid import GridPlane, Marginal
from fogproof.checks.statistics.cells import (
    BLURRED,
    EXACT,
    EXPLAINED,
    HIDDEN,
    MISS,
    between,
    blocks,
    drowned,
    unevenness,
)
from fogproof.checks.statistics.tails import (
    chi_square_above,
    chi_square_detected,
)
from fogproof.checks.verdict import Finding, Outcome, Resolution

_FEWEST = 4  # cells along each axis of the plane
_LEAST = 20.0  # samples expected in a cell: the chi-square law is then accurate far into its tail
_CONTINUOUS = 8  # cells: with fewer, the statistic takes few values


def chi_square_along(name: str, marginal: Marginal, counts: np.ndarray, cells: int, alpha: float) -> Finding:
    """Pearson's test on up to `cells` groups of about equal probability along one axis."""
    n = counts.sum()
    cells = max(min(cells, int(n / _LEAST), len(counts)), 1)
    while True:
        at = _edges(marginal, cells)
        error, mass = marginal.doubt(at[:-1], at[1:]), np.diff(marginal.cdf[at])
        blur = marginal.blur[at[:-1]] + marginal.blur[at[1:]]
        sharp = np.all(error <= BLURRED * np.sqrt(mass / max(n, 1))) and not drowned(n, mass, blur)
        if cells < 32 or sharp:
            break
        cells //= 2  # fewer samples fluctuate in smaller cells: what is known of larger ones may be enough
    finding = chi_square(name, np.add.reduceat(counts, at[:-1]), mass, error, blur, alpha)
    observed = np.add.reduceat(counts, at[:-1])
    return finding if finding.outcome != "rejected" else finding.located(between_worst(marginal, at, observed))


def _edges(marginal: Marginal, cells: int) -> np.ndarray:
    """Return the numbers of the edges between up to `cells` groups of about equal probability.

    Cells of a grid are equally probable; those of a table may be anything: one that has more than a group should stands alone.
    """
    m = len(marginal.cdf) - 1
    if not marginal.whole:
        return np.unique(np.arange(cells + 1) * m // cells)
    inner = np.searchsorted(marginal.cdf, np.arange(1, cells) / cells)
    heavy = np.flatnonzero(np.diff(marginal.cdf) > 1 / cells)
    return np.unique(np.concatenate([[0], np.minimum(inner, m), heavy, heavy + 1, [m]]))


def between_worst(marginal: Marginal, at: np.ndarray, observed: np.ndarray) -> str:
    """Return in words where the counts between the edges `at` misfit most, and in which direction."""
    n, mass = observed.sum(), np.diff(marginal.cdf[at])
    z = (observed - n * mass) / np.sqrt(np.maximum(n * mass, 1))
    worst = int(np.argmax(np.abs(z)))
    many = "too many" if z[worst] > 0 else "too few"
    return f"{many} samples in {between(marginal, at[worst], at[worst + 1])} (z = {z[worst]:+.1f})"


def chi_square(
    name: str,
    counts: np.ndarray,
    mass: np.ndarray,
    mass_error: np.ndarray,
    blur: np.ndarray,
    alpha: float,
) -> Finding:
    """Likelihood-ratio test that the cells (any shape) have the probabilities `mass`, which sum to 1 and are known to `mass_error`.

    `blur` is what the rounding of points can move: it lessens the statistic like an error, but is no reason to doubt. Neighbouring
    cells are pooled until 20 samples are expected in each. The statistic 2 sum O log(O/E), divided by Bartlett's factor, follows
    the chi-square law far into the tail, where Pearson's would not: a Poisson count of 44 where 20 are expected has probability
    2e-6, its deviance says 2e-6 too, and its square 7e-8.
    """
    n = int(counts.sum())
    groups = pooled(n * mass.ravel(), _LEAST)
    columns = (counts, n * mass, n * mass_error, n * blur)
    observed, expected, error, rounding = (np.bincount(groups, values.ravel()) for values in columns)
    cells = len(observed)
    if cells < 2:
        message = f"fewer than two cells expect {_LEAST:g} samples; ask for more samples"
        return Finding(name, "inconclusive", message, alpha=alpha)
    sigma = np.sqrt(expected)
    slack = error + rounding
    nearest = np.clip(observed, expected - slack, expected + slack)
    bartlett = 1 + float(np.sum(1 / expected) - 1 / n) / (6 * (cells - 1))
    statistic = float(np.sum(deviances(observed, nearest))) / bartlett
    p = chi_square_above(cells - 1, statistic)
    # In a few cells of many, doubt costs what the resolution says, and no more.
    blurred = bool(np.mean((error / sigma) ** 2) > BLURRED**2)
    hides = math.sqrt(float(np.sum(slack**2 / expected)) / n)
    hidden = statistic == 0 and hides > HIDDEN
    outcome: Outcome = "rejected" if p <= alpha else "inconclusive" if blurred or hidden else "not rejected"
    effect = float(0.5 * np.sum(np.abs(observed - expected)) / n)
    message = f"chi-square = {statistic:.5g} on {cells - 1} degrees of freedom"
    if outcome == "inconclusive":
        coarse = "; the expected masses are known too coarsely to tell: give a cdf, or a smoother pdf"
        message += coarse if blurred else EXPLAINED
    exact = bool(np.all(slack <= EXACT * sigma)) and cells >= _CONTINUOUS
    cause = "shape" if outcome == "rejected" else ""
    seen = math.sqrt(bartlett * chi_square_detected(cells - 1, alpha, MISS) / n) + hides
    resolution = Resolution(unevenness(cells), seen, MISS)
    return Finding(name, outcome, message, p, alpha, exact, statistic, effect, resolution=resolution, cause=cause)


def joint(name: str, plane: GridPlane, counts: np.ndarray, alpha: float) -> Finding:
    """Likelihood-ratio test of the counts (32, 32) on the coarse plane, or on fewer cells if rounding drowns these."""
    cells, n = len(plane.mass), float(counts.sum())
    while cells > _FEWEST and drowned(n, blocks(plane.mass, cells), plane.blur(cells)):
        cells //= 2
    observed, mass, error = (blocks(values, cells) for values in (counts, plane.mass, plane.error))
    return chi_square(name, observed, mass, error, plane.blur(cells), alpha)


def deviances(observed: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Return (m,) 2 (O log(O/E) - (O - E)) of Poisson counts: about the square of a normal number, however small E is."""
    expected = np.maximum(expected, 1e-300)
    ratio = np.maximum(observed, 1e-300) / expected
    return 2 * (np.where(observed > 0, observed * np.log(ratio), 0.0) - (observed - expected))


def pooled(expected: np.ndarray, least: float) -> np.ndarray:
    """Return a group number for each cell; consecutive cells share one until its expectation reaches `least`."""
    if len(expected) and expected.min() >= least:
        return np.arange(len(expected))
    groups = np.empty(len(expected), dtype=np.intp)
    group, total = 0, 0.0
    for i, value in enumerate(expected.tolist()):
        groups[i] = group
        total += value
        if total >= least:
            group, total = group + 1, 0.0
    if total > 0 or (len(groups) and groups[-1] == group):
        groups[groups == group] = max(group - 1, 0)
    return groups
