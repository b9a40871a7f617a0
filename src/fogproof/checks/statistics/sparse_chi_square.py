"""Pearson's chi-square on very many cells of a few samples each: Pearson's type III law."""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.density.grid import GridPlane
from fogproof.checks.statistics.cells import (
    EXACT,
    EXPLAINED,
    HIDDEN,
    MISS,
    blocks,
    drowned,
    nothing_counted,
    unevenness,
)
from fogproof.checks.statistics.tails import (
    gamma_above,
    normal_quantile,
)
from fogproof.checks.verdict import Finding, Outcome, Resolution


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


def chi_square_sparse(name: str, counts: np.ndarray, mass: np.ndarray, blur: np.ndarray, alpha: float) -> Finding:
    """Pearson's test on very many cells that expect a few samples each, (m,): it sees samples that fill the plane unevenly.

    The p-value is that of the gamma law with the statistic's mean and its second and third cumulants (Pearson's type III). They are
    those of independent Poisson counts, regressed on their sum, which is given: the slope of the statistic on it is cells / n.
    """
    n = int(counts.sum())
    if n == 0:
        return nothing_counted(name, alpha)
    expected = n * mass
    exact = bool(np.all(n * blur <= EXACT * np.sqrt(expected)))
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
