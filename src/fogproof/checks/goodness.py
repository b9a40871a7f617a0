"""Goodness of fit on counted cells: chi-square, fine and coarse, and the Dvoretzky-Kiefer-Wolfowitz-Massart inequality.

Each test takes the bound on the expected masses' own error into account: a difference that quadrature alone could explain never
rejects.
"""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.verdict import Finding, Outcome, Resolution

MISS = 0.01
"""Every resolution is stated for this probability of missing the error."""


def chi_square(
    name: str, counts: np.ndarray, mass: np.ndarray, mass_error: np.ndarray, n: int, alpha: float
) -> Finding:
    """Pearson's test that the cells (any shape) have the probabilities `mass`, each known to within `mass_error`.

    Neighbouring cells are pooled until 20 samples are expected in each; the p-value of the chi-square law is then accurate far
    into its tail, and uniform for a right sampler as long as `mass_error` is negligible.
    """
    from scipy.special import chdtrc

    groups = _pool(n * mass.ravel(), 20.0)
    observed, expected, error = (np.bincount(groups, values.ravel()) for values in (counts, n * mass, n * mass_error))
    cells = len(observed)
    if cells < 2:
        message = "fewer than two cells expect 20 samples; ask for more samples"
        return Finding(name, "inconclusive", message, alpha=alpha)
    sigma = np.sqrt(np.maximum(expected, 1e-300))
    excess = np.maximum(np.abs(observed - expected) - error, 0)
    statistic = float(np.sum((excess / sigma) ** 2))
    p = float(chdtrc(cells - 1, statistic))
    blurred = bool(np.any(error > 0.1 * sigma))
    outcome: Outcome = "rejected" if p <= alpha else "inconclusive" if blurred else "not rejected"
    effect = float(0.5 * np.sum(np.abs(observed - expected)) / n)
    message = f"chi-square = {statistic:.5g} on {cells - 1} degrees of freedom"
    if outcome == "inconclusive":
        message += "; the expected masses are known too coarsely to tell: give a cdf, or a smoother pdf"
    exact = bool(np.all(error <= 0.01 * sigma))
    return Finding(name, outcome, message, p, alpha, exact, statistic, effect)


def _pool(expected: np.ndarray, least: float) -> np.ndarray:
    """Return a group number for each cell; consecutive cells share one until its expectation reaches `least`."""
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


def kolmogorov(
    name: str,
    label: str,
    counts: np.ndarray,
    mass: np.ndarray,
    mass_error: np.ndarray,
    n: int,
    alpha: float,
    gap: float,
) -> Finding:
    """Kolmogorov's distance on the edges of a marginal's cells, judged by Massart's inequality (1990).

    counts, mass, mass_error are (cells,). The p-value is an upper bound, valid for every n. Between two edges the distance can be
    larger by the probability between them: `gap` is the largest, and the resolution counts it.
    """
    difference = np.abs(np.cumsum(counts) / n - np.cumsum(mass))
    distance = float(np.max(np.maximum(difference - np.cumsum(mass_error), 0)))
    p = min(1.0, 2 * math.exp(-2 * n * distance**2))
    critical = math.sqrt(math.log(2 / alpha) / (2 * n))
    resolution = Resolution(
        f"Kolmogorov distance in {label}",
        critical + math.sqrt(math.log(1 / MISS) / (2 * n)) + gap + float(mass_error.sum()),
        MISS,
    )
    where = int(np.argmax(difference))
    message = f"largest distance between the cumulative distributions in {label} is {distance:.3g}"
    if p <= alpha:
        message += f", after cell {where + 1} of {len(mass)}"
    return Finding(
        name, "rejected" if p <= alpha else "not rejected", message, p, alpha, False, distance, distance, resolution
    )


def binomial(name: str, what: str, count: int, n: int, low: float, high: float, alpha: float) -> Finding:
    """Exact two-sided binomial test that a probability lies in [low, high] (a point, or known to within an error)."""
    p = binomial_p(count, n, low, high)
    share = count / n
    centre = 0.5 * (low + high)
    spread = math.sqrt(max(centre * (1 - centre), 1 / n) / n)
    resolution = Resolution(f"error of {what}", (_normal_quantile(alpha / 2) + _normal_quantile(MISS)) * spread, MISS)
    message = f"{what} is {centre:.6g}, observed {share:.6g} ({count} of {n})"
    outcome: Outcome = "rejected" if p <= alpha else "not rejected"
    return Finding(name, outcome, message, p, alpha, False, share, share - centre, resolution)


def binomial_p(count: int, n: int, low: float, high: float) -> float:
    """Return the two-sided p-value (twice the smaller tail) of `count` under the kindest probability in [low, high]."""
    from scipy.special import bdtr, bdtrc

    low, high = min(max(low, 0.0), 1.0), min(max(high, 0.0), 1.0)
    below = 1.0 if count >= n else float(bdtr(count, n, low))  # P(X <= count) is largest at the smallest probability
    above = 1.0 if count <= 0 else float(bdtrc(count - 1, n, high))
    return min(1.0, 2 * min(below, above))


def _normal_quantile(tail: float) -> float:
    from scipy.special import ndtri

    return float(-ndtri(tail))
