"""Goodness of fit on counted cells: Kolmogorov's distance, Pearson's chi-square, and the exact binomial law.

Each test takes the bound on the expected masses' own error into account: a difference that quadrature or the rounding of points
alone could explain never rejects.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fogproof.checks.density.grid import GridPlane, Marginal
from fogproof.checks.statistics.tails import (
    binomial_at_least,
    binomial_at_most,
    binomial_interval,
    chi_square_above,
    chi_square_detected,
    gamma_above,
    normal_quantile,
)
from fogproof.checks.verdict import EffectInterval, Finding, Outcome, Resolution

MISS = 0.01
"""Every resolution is stated for this probability of missing the error."""

HIDDEN = 0.5
"""Root mean square of the ratio of densities less 1: where rounding could explain so much, seeing nothing is no pass."""

EXPLAINED = "; rounding explains any difference there could be: nothing can be told"
"""What is said where single precision leaves nothing to see."""

_FEWEST = 4  # cells along each axis of the plane
_LEAST = 20.0  # samples expected in a cell: the chi-square law is then accurate far into its tail
_BLURRED = 0.1  # standard deviations of a count: an expectation known less well makes a test inconclusive
_CONTINUOUS = 8  # cells: with fewer, the statistic takes few values
_EXACT = 0.01  # standard deviations: an expectation known better leaves p-values uniform
_MOVED = 0.1  # of probability that rounding may move: where that is not seen, nothing is known


def kolmogorov(name: str, marginal: Marginal, counts: np.ndarray, alpha: float) -> Finding:
    """Kolmogorov's distance between the counts (m,) of a marginal's cells and its cdf, judged by Massart's inequality (1990).

    The p-value is an upper bound, valid for every number of samples. Between two edges the distance can be larger by the
    probability between them: the resolution counts it.
    """
    n = int(counts.sum())
    if n == 0:
        return nothing_counted(name, alpha)
    signed = np.concatenate([[0.0], np.cumsum(counts)]) / n - marginal.cdf
    excess = np.maximum(np.abs(signed) - marginal.error - marginal.blur, 0)
    where = int(np.argmax(excess))
    distance = float(excess[where])
    p = min(1.0, 2 * math.exp(-2 * n * distance**2))
    spread = math.sqrt(math.log(2 / MISS) / (2 * n))
    seen = float(np.max(np.abs(signed)))
    blind = float(np.max(marginal.error + marginal.blur)) + (0.0 if marginal.whole else float(np.max(marginal.mass)))
    resolution = Resolution(
        f"Kolmogorov distance in {marginal.label}", kolmogorov_critical(n, alpha) + spread + blind, MISS
    )
    message = f"largest distance between the cumulative distributions in {marginal.label} is {seen:.3g}"
    blurred = bool(np.max(marginal.error) * math.sqrt(n) > _BLURRED)
    hidden = blind > _MOVED and not marginal.whole
    outcome: Outcome = "rejected" if p <= alpha else "inconclusive" if blurred or hidden else "not rejected"
    if outcome == "inconclusive":
        message += "; the cdf is known too coarsely to tell: give one, or a smoother pdf" if blurred else EXPLAINED
    if p <= alpha:
        share, claim = marginal.cdf[where] + signed[where], marginal.cdf[where]
        message += f": {share:.4g} of the samples have {below(marginal, where)}, the pdf says {claim:.4g}"
    return Finding(
        name,
        outcome,
        message,
        p,
        alpha,
        False,
        distance,
        seen,
        resolution,
        interval=EffectInterval(max(seen - spread, 0.0), min(seen + spread, 1.0), 1 - MISS),
        region=(below(marginal, where),) if p <= alpha else (),
        cause="shape" if p <= alpha else "",
    )


def kolmogorov_critical(n: int, alpha: float) -> float:
    """Return the distance that n samples reject at alpha."""
    return math.sqrt(math.log(2 / alpha) / (2 * n))


def below(marginal: Marginal, edge: int) -> str:
    """Return in words which part of the axis lies before an edge."""
    sign = "<" if marginal.shown[-1] > marginal.shown[0] else ">"
    return f"{marginal.label} {sign} {marginal.shown[edge]:.5g}"


def between(marginal: Marginal, first: int, last: int) -> str:
    """Return in words which part of the axis lies between two edges."""
    low, high = sorted((marginal.shown[first], marginal.shown[last]))
    return f"{low:.6g} < {marginal.label} < {high:.6g}"


def chi_square_along(name: str, marginal: Marginal, counts: np.ndarray, cells: int, alpha: float) -> Finding:
    """Pearson's test on up to `cells` groups of about equal probability along one axis."""
    n = counts.sum()
    cells = max(min(cells, int(n / _LEAST), len(counts)), 1)
    while True:
        at = np.unique(np.arange(cells + 1) * len(counts) // cells)
        error, mass = marginal.doubt(at[:-1], at[1:]), np.diff(marginal.cdf[at])
        blur = marginal.blur[at[:-1]] + marginal.blur[at[1:]]
        sharp = np.all(error <= _BLURRED * np.sqrt(mass / max(n, 1))) and not drowned(n, mass, blur)
        if cells < 32 or sharp:
            break
        cells //= 2  # fewer samples fluctuate in smaller cells: what is known of larger ones may be enough
    finding = chi_square(name, np.add.reduceat(counts, at[:-1]), mass, error, blur, alpha)
    observed = np.add.reduceat(counts, at[:-1])
    return finding if finding.outcome != "rejected" else finding.located(between_worst(marginal, at, observed))


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
    blurred = bool(np.mean((error / sigma) ** 2) > _BLURRED**2)
    hides = math.sqrt(float(np.sum(slack**2 / expected)) / n)
    hidden = statistic == 0 and hides > HIDDEN
    outcome: Outcome = "rejected" if p <= alpha else "inconclusive" if blurred or hidden else "not rejected"
    effect = float(0.5 * np.sum(np.abs(observed - expected)) / n)
    message = f"chi-square = {statistic:.5g} on {cells - 1} degrees of freedom"
    if outcome == "inconclusive":
        coarse = "; the expected masses are known too coarsely to tell: give a cdf, or a smoother pdf"
        message += coarse if blurred else EXPLAINED
    exact = bool(np.all(slack <= _EXACT * sigma)) and cells >= _CONTINUOUS
    cause = "shape" if outcome == "rejected" else ""
    seen = math.sqrt(bartlett * chi_square_detected(cells - 1, alpha, MISS) / n) + hides
    resolution = Resolution(unevenness(cells), seen, MISS)
    return Finding(name, outcome, message, p, alpha, exact, statistic, effect, resolution=resolution, cause=cause)


def unevenness(cells: int) -> str:
    """Return the name of the misfit that a chi-square on so many cells sees."""
    return f"misfit that is even in each of {cells} cells (root mean square of the ratio of densities less 1)"


def drowned(n: float, mass: np.ndarray, blur: np.ndarray) -> bool:
    """Return whether rounding may move more samples in and out of most cells than chance does."""
    return bool(n * np.mean(blur**2 / np.maximum(mass, 1e-300)) > 1)


def joint(name: str, plane: GridPlane, counts: np.ndarray, alpha: float) -> Finding:
    """Likelihood-ratio test of the counts (32, 32) on the coarse plane, or on fewer cells if rounding drowns these."""
    cells, n = len(plane.mass), float(counts.sum())
    while cells > _FEWEST and drowned(n, blocks(plane.mass, cells), plane.blur(cells)):
        cells //= 2
    observed, mass, error = (blocks(values, cells) for values in (counts, plane.mass, plane.error))
    return chi_square(name, observed, mass, error, plane.blur(cells), alpha)


def joint_fine(name: str, plane: GridPlane, counts: np.ndarray, alpha: float) -> Finding:
    """Pearson's test on the finest plane of independent axes, counts (size, size), that rounding does not drown."""
    cells, n = plane.size, float(counts.sum())
    while True:
        first, second = (share.reshape(cells, -1).sum(axis=1) for share in plane.shares)
        mass, blur = first[:, None] * second, plane.blur(cells)
        if cells <= len(plane.mass) or not drowned(n, mass, blur):
            break
        cells //= 2
    return chi_square_sparse(name, blocks(counts, cells).ravel(), mass.ravel(), blur.ravel(), alpha)


def blocks(values: np.ndarray, size: int) -> np.ndarray:
    """Return the sums of square blocks of (n, n) values, (size, size)."""
    if len(values) == size:
        return values
    step = len(values) // size
    return np.asarray(values.reshape(size, step, size, step).sum(axis=(1, 3)))


def deviances(observed: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Return (m,) 2 (O log(O/E) - (O - E)) of Poisson counts: about the square of a normal number, however small E is."""
    expected = np.maximum(expected, 1e-300)
    ratio = np.maximum(observed, 1e-300) / expected
    return 2 * (np.where(observed > 0, observed * np.log(ratio), 0.0) - (observed - expected))


def chi_square_sparse(name: str, counts: np.ndarray, mass: np.ndarray, blur: np.ndarray, alpha: float) -> Finding:
    """Pearson's test on very many cells that expect a few samples each, (m,): it sees samples that fill the plane unevenly.

    The p-value is that of the gamma law with the statistic's mean and its second and third cumulants (Pearson's type III). They are
    those of independent Poisson counts, regressed on their sum, which is given: the slope of the statistic on it is cells / n.
    """
    n = int(counts.sum())
    if n == 0:
        return nothing_counted(name, alpha)
    expected = n * mass
    exact = bool(np.all(n * blur <= _EXACT * np.sqrt(expected)))
    misfit = counts - expected if exact else np.maximum(np.abs(counts - expected) - n * blur, 0.0)
    statistic = float(np.sum(misfit**2 / expected))
    cells = len(expected)
    inverse, slope = 1 / expected, cells / n
    variance = float(np.sum(2 + inverse)) - slope * cells
    third = float(np.sum(8 + 22 * inverse + inverse**2 - 3 * slope * (8 + inverse)))
    third += 3 * slope**2 * (2 * n + cells) - slope**3 * n
    shape, scale = 4 * variance**3 / third**2, third / (2 * variance)
    p = gamma_above(shape, (statistic - (cells - 1)) / scale + shape)
    rejected = p <= alpha
    uneven = max((statistic - cells) / max(n, 1), 0.0)
    message = f"chi-square = {statistic:.7g} on {cells - 1} degrees of freedom, {n / cells:.2g} samples a cell"
    hides = math.sqrt(float(np.sum(blur**2 / mass)))
    hidden = statistic == 0 and hides > HIDDEN
    outcome: Outcome = "rejected" if rejected else "inconclusive" if hidden else "not rejected"
    message += EXPLAINED if hidden else ""
    seen = _reach(shape, scale, variance, alpha) / math.sqrt(n) + hides
    resolution = Resolution(unevenness(cells), seen, MISS)
    cause = "correlation" if rejected else ""
    return Finding(
        name,
        outcome,
        message,
        p,
        alpha,
        exact,
        statistic,
        math.sqrt(uneven),
        resolution=resolution,
        cause=cause,
    )


def _reach(shape: float, scale: float, variance: float, alpha: float) -> float:
    """Return the root of the excess of a sum of squares with gamma's shape and scale that is found but for `MISS`."""
    from scipy.special import gammainccinv

    needed = scale * (float(gammainccinv(shape, alpha)) - shape)
    miss = normal_quantile(MISS)
    excess = needed + miss * math.sqrt(variance)
    for _ in range(20):  # an uneven density makes the sum fluctuate more
        excess = needed + miss * math.sqrt(variance + 4 * excess)
    return math.sqrt(excess)


def nothing_counted(name: str, alpha: float) -> Finding:
    """Return what is to be said where no sample belongs to the continuous part."""
    return Finding(name, "inconclusive", "no sample belongs to the continuous part", alpha=alpha)


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


def binomial(name: str, what: str, count: int, n: int, low: float, high: float, cause: str, alpha: float) -> Finding:
    """Exact two-sided binomial test that a probability lies in [low, high] (a point, or known to within an error)."""
    p = binomial_p(count, n, low, high)
    share = count / n
    centre = 0.5 * (low + high)
    resolution = Resolution(f"error of {what}", binomial_resolution(n, low, high, alpha), MISS)
    message = f"{what} is {centre:.6g}, observed {share:.6g} ({count} of {n})"
    rejected = p <= alpha
    ends = binomial_interval(count, n, MISS)
    return Finding(
        name,
        "rejected" if rejected else "not rejected",
        message,
        p,
        alpha,
        False,
        share,
        share - centre,
        resolution,
        interval=EffectInterval(ends[0] - centre, ends[1] - centre, 1 - MISS),
        cause=cause if rejected else "",
    )


def binomial_resolution(n: int, low: float, high: float, alpha: float) -> float:
    """Return by how much a probability must differ from the middle of [low, high] to be rejected, but for `MISS`: exact.

    The least count above and the greatest below that are rejected are searched, and the probabilities that reach them.
    """
    from scipy.special import betaincinv

    centre = 0.5 * (low + high)
    least = _first(lambda k: binomial_at_least(k, n, min(high, 1.0)) <= alpha / 2, 0, n + 1)
    most = _first(lambda k: binomial_at_most(k, n, max(low, 0.0)) > alpha / 2, 0, n + 1) - 1
    up = float(betaincinv(least, n - least + 1, 1 - MISS)) - centre if least <= n else 0.0
    down = centre - float(betaincinv(most + 1, n - most, MISS)) if most >= 0 else 0.0
    return max(up, down) if max(up, down) > 0 else 1.0


def _first(good: Callable[[int], bool], low: int, high: int) -> int:
    """Return the first whole number in [low, high) from which on `good` holds, `high` if there is none."""
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if good(middle) else (middle + 1, high)
    return low


def binomial_p(count: int, n: int, low: float, high: float) -> float:
    """Return the two-sided p-value (twice the smaller tail) of `count` under the kindest probability in [low, high]."""
    low, high = min(max(low, 0.0), 1.0), min(max(high, 0.0), 1.0)
    below = binomial_at_most(count, n, low)  # largest at the smallest probability
    above = binomial_at_least(count, n, high)
    return min(1.0, 2 * min(below, above))
