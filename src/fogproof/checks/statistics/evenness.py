"""Are the counts of one call as uneven as those of independent samples?

Points of a call that are stratified, a Latin hypercube or a low-discrepancy sequence, in whatever order, fill cells too evenly:
all calls have about the same counts. Held against each other, calls need no known probabilities: Pearson's statistic of their
homogeneity lies in its lower tail.

Pairs of x and its mirror image, or of x and x + 1/2 (shares of the axis), fill each cell by chance and its mate alike, wherever in
the call the two stand: how a pair of mated cells shares its samples varies too little from call to call.
"""

from __future__ import annotations

import numpy as np

from fogproof.checks.statistics.cells import MISS
from fogproof.checks.verdict import Finding, Resolution

GROUPS = 32
"""Cells of about equal probability along each axis."""

CALLS = 16
"""Calls whose counts are remembered."""

_MATES = {"at the mirrored place": np.arange(GROUPS)[::-1], "half an axis on": np.roll(np.arange(GROUPS), GROUPS // 2)}
"""Where the second sample of a pair may lie: the mate of each cell."""

_LEAST = 50.0  # samples expected in a cell of a call
_FEWEST = 15  # degrees of freedom: with fewer, counts are equal by chance


def evenness_test(
    name: str, labels: tuple[str, ...], calls: np.ndarray, alpha: float, meant: str = "declare quasi_random=True"
) -> Finding:
    """Test that calls differ as independent samples do; calls (calls, axes, cells) counts, along each axis.

    meant  what to do if the samples are to be so even, in words
    """
    from scipy.special import chdtr, chdtri

    worst = (2.0, 0, "", 0.0, 0)
    rivals = len(labels) * (1 + len(_MATES))
    for axis, label in enumerate(labels):
        counts = calls[:, axis]
        found = [_homogeneity(counts), *(_between_mates(counts, mates) for mates in _MATES.values())]
        for order, (statistic, freedom) in enumerate(found):
            if freedom >= _FEWEST:
                p = min(1.0, rivals * float(chdtr(freedom, statistic)))
                worst = min(worst, (p, order, label, statistic / freedom, freedom))
    p, order, label, share, freedom = worst
    mates = ("", *_MATES)[order]
    if not freedom:
        message = "too few samples in a call to see whether it is stratified"
        return Finding(name, "not rejected", message, 1.0, alpha)
    least = float(chdtri(freedom, 1 - alpha / rivals) / chdtri(freedom, MISS))
    resolution = Resolution("share missing of the variance of a call's counts", 1 - least, MISS)
    what = f"counts along {label}" + (f", less those {mates}," if mates else "")
    message = f"between calls, {what} vary {share:.3g} times as much as those of independent samples"
    if p > alpha:
        return Finding(name, "not rejected", message, p, alpha, False, share, 1 - share, resolution)
    advice = "antithetic pairs" if mates else "a stratified or low-discrepancy stream"
    advice += f", in whatever order; if it is meant, {meant}"
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
        cause="correlation" if mates else "stratified samples",
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


def _between_mates(counts: np.ndarray, mates: np.ndarray) -> tuple[float, int]:
    """Return Pearson's statistic of how mated cells share their samples (calls, cells), and its degrees of freedom."""
    counts = counts[counts.sum(axis=1) > 0]
    first = np.flatnonzero(np.arange(len(mates)) < mates)
    a, both = counts[:, first], counts[:, first] + counts[:, mates[first]]
    with np.errstate(invalid="ignore", divide="ignore"):
        share = a.sum(axis=0) / both.sum(axis=0)
        least = both.min(axis=0, initial=1 << 62) * np.minimum(share, 1 - share)
        used = least >= _LEAST
        statistic = (a - both * share) ** 2 / (both * share * (1 - share))
    return float(statistic[:, used].sum()), (len(counts) - 1) * int(np.count_nonzero(used))
