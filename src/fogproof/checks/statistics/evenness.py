"""Are the counts of one call as uneven as those of independent samples?

Points of a call that are stratified, a Latin hypercube or a low-discrepancy sequence, in whatever order, fill cells too evenly:
all calls have about the same counts. Held against each other, calls need no known probabilities: Pearson's statistic of their
homogeneity lies in its lower tail.
"""

from __future__ import annotations

import numpy as np

from fogproof.checks.statistics.cells import MISS
from fogproof.checks.verdict import Finding, Resolution

GROUPS = 32
"""Cells of about equal probability along each axis."""

CALLS = 16
"""Calls whose counts are remembered."""

_LEAST = 50.0  # samples expected in a cell of a call
_FEWEST = 15  # degrees of freedom: with fewer, counts are equal by chance


def evenness_test(
    name: str, labels: tuple[str, ...], calls: np.ndarray, alpha: float, meant: str = "declare quasi_random=True"
) -> Finding:
    """Test that calls differ as independent samples do; calls (calls, axes, cells) counts, along each axis.

    meant  what to do if the samples are to be so even, in words
    """
    from scipy.special import chdtr, chdtri

    worst = (1.0, "", 0.0, 0)
    for axis, label in enumerate(labels):
        statistic, freedom = _homogeneity(calls[:, axis])
        if freedom >= _FEWEST:
            p = min(1.0, len(labels) * float(chdtr(freedom, statistic)))
            worst = min(worst, (p, label, statistic / freedom, freedom))
    p, label, share, freedom = worst
    if not freedom:
        message = "too few samples in a call to see whether it is stratified"
        return Finding(name, "not rejected", message, 1.0, alpha)
    least = float(chdtri(freedom, 1 - alpha / len(labels)) / chdtri(freedom, MISS))
    resolution = Resolution("share missing of the variance of a call's counts", 1 - least, MISS)
    message = f"between calls, counts along {label} vary {share:.3g} times as much as those of independent samples"
    if p > alpha:
        return Finding(name, "not rejected", message, p, alpha, False, share, 1 - share, resolution)
    advice = f"a stratified or low-discrepancy stream; if it is meant, {meant}"
    return Finding(
        name,
        "rejected",
        f"{message}: {advice}",
        p,
        alpha,
        False,
        share,
        1 - share,
        resolution,
        cause="stratified samples",
    )


def _homogeneity(counts: np.ndarray) -> tuple[float, int]:
    """Return Pearson's statistic of equal shares in all calls (calls, cells), and its degrees of freedom."""
    n = counts.sum(axis=1, keepdims=True)
    if n.sum() == 0:
        return 0.0, 0
    counts, n = counts[n[:, 0] > 0], n[n[:, 0] > 0]
    expected = n * (counts.sum(axis=0) / n.sum())
    used = expected.min(axis=0) >= _LEAST
    cells = int(np.count_nonzero(used))
    if cells < 2:
        return 0.0, 0
    statistic = float(np.sum((counts[:, used] - expected[:, used]) ** 2 / expected[:, used]))
    # The other cells may never be hit, as between two values; one degree fewer is right then, and safe where they are.
    return statistic, (len(n) - 1) * (cells - 1)
