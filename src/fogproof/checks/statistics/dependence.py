"""Are realisations independent? Neighbours at several distances, mirrored halves, the spread of calls, and what occurs twice.

All hold whatever the law of the values: standard errors of dependent realisations are wrong even where the mean is right.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fogproof.checks.statistics.binomial import binomial_p
from fogproof.checks.statistics.evenness import evenness_test
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.succession import WAYS, WINDOW, Succession
from fogproof.checks.statistics.tails import binomial_at_least, binomial_at_most, gamma_above, normal_two_sided
from fogproof.checks.verdict import Finding, Outcome

_CHANCE = 1e-12  # a repetition less likely than this is none
_MANY = 1e4  # expected pairs of large values: the normal law is then accurate far into its tail
_NEARLY_NORMAL = (
    0.02  # skewness, and excess kurtosis, of the mean of a call whose scatter is tested by chi-square's law
)


def runs_test(name: str, record: Succession, alpha: float) -> Finding:
    """Test that a large value is accompanied by a large one as often as by a small one (Wald & Wolfowitz 1940).

    Every distance and channel is asked, and the smallest p-value is multiplied by how many were.
    """
    found = [
        (p, correlation, z, f"{where}{f', channel {channel}' if len(record.large) > 1 else ''}")
        for way, where in enumerate(WAYS)
        for channel in range(len(record.large))
        for p, correlation, z in [concordance(record, way, channel)]
    ]
    p, correlation, z, where = min(found, key=lambda one: (one[0], -abs(one[1])))
    if all(one[2] == 0 for one in found):
        return Finding(name, "not rejected", "too few large or small values to see a correlation", 1.0, alpha)
    p = min(1.0, p * len(found))
    outcome: Outcome = "rejected" if p <= alpha else "not rejected"
    message = f"correlation of realisations {where}, large against small, is {correlation:+.3g}"
    cause = "correlation" if outcome == "rejected" else ""
    return Finding(name, outcome, message, p, alpha, False, z, correlation, cause=cause)


def concordance(record: Succession, way: int, channel: int) -> tuple[float, float, float]:
    """Return the p-value, the correlation and its z of one way to pair realisations; (1, 0, 0) where there is little to see."""
    pairs, both = int(record.pairs[way]), int(record.both[way, channel])
    share = int(record.large[channel]) / max(record.n, 1)
    spread = share * (1 - share)
    if pairs * spread**2 < 25:
        return 1.0, 0.0, 0.0
    correlation = (both / pairs - share**2) / spread
    z = correlation * math.sqrt(pairs)
    p = normal_two_sided(z)
    if (
        pairs * spread**2 < _MANY
    ):  # of a large value's companions so many are large: hypergeometric, bounded by the binomial law
        ones = round(pairs * share)
        p = max(p, min(1.0, 2 * min(binomial_at_least(both, ones, share), binomial_at_most(both, ones, share))))
    return p, correlation, z


def spread_of_calls(name: str, record: Succession, data: Sequence[Moments], alpha: float) -> Finding | None:
    """Test that means of whole calls scatter as those of independent realisations: chi-square, both ways.

    Stratified or antithetic realisations scatter less, dependent ones more, in whatever order they are returned. None where
    there are too few calls large enough for their means to be about normal.
    """
    worst: tuple[float, float, int] | None = None
    channels = 0
    for channel, moments in enumerate(data):
        calls = [(n, float(mean[channel])) for n, mean in record.means if _nearly_normal(moments, n)]
        if len(calls) < 4:
            continue
        channels += 1
        sizes = np.array([n for n, _ in calls], dtype=float)
        offs = (np.array([mean for _, mean in calls]) - moments.mean) / moments.deviation
        offs -= np.sum(sizes * offs) / np.sum(sizes)
        statistic, freedom = float(np.sum(sizes * offs**2)), len(calls) - 1
        p = min(1.0, 2 * min(gamma_above(0.5 * freedom, 0.5 * statistic), _gamma_below(0.5 * freedom, 0.5 * statistic)))
        if worst is None or p < worst[0]:
            worst = (p, statistic / freedom, len(calls))
    if worst is None:
        return None
    p = min(1.0, worst[0] * channels)
    rejected = p <= alpha
    message = f"means of {worst[2]} calls vary {worst[1]:.3g} times as much as those of independent realisations"
    message += "; realisations of one call depend on each other" if rejected else ""
    outcome: Outcome = "rejected" if rejected else "not rejected"
    return Finding(name, outcome, message, p, alpha, False, worst[1], worst[1], cause="correlation" if rejected else "")


def evenness_of_calls(name: str, record: Succession, alpha: float) -> Finding | None:
    """Test that the values of a call fill cells as unevenly as independent ones do; None where no two calls are large enough."""
    if len(record.counts) < 2:
        return None
    labels = tuple(f"channel {c}" for c in range(len(record.edges))) if len(record.edges) > 1 else ("the values",)
    # What is promised of an estimator is its mean; the smallest share of stratification that is seen is no promise about that.
    meant = "return the mean of each such set of points as one realisation"
    return replace(evenness_test(name, labels, np.stack(record.counts), alpha, meant), resolution=None)


def _nearly_normal(data: Moments, n: int) -> bool:
    if data.m2 <= 0 or n < 8:
        return False
    kurtosis = data.n * data.m4 / data.m2**2 - 3
    return abs(data.skewness) / math.sqrt(n) < _NEARLY_NORMAL and abs(kurtosis) / n < _NEARLY_NORMAL


def _gamma_below(shape: float, x: float) -> float:
    from scipy.special import gammainc

    return float(gammainc(shape, x))


def repeats_within_calls(name: str, record: Succession, alpha: float) -> Finding | None:
    """Test that a value which occurs twice does so within one call as rarely as the sizes of the calls say.

    Of values that come up by chance, any two occurrences are equally likely to be any two realisations; realisations that are
    returned twice lie in one call, those of a generator that starts again lie in two. None where nothing occurs twice.
    """
    n = len(record.prints)
    counts = np.bincount(record.calls) if n else np.zeros(1)
    chance = float(np.sum(counts * (counts - 1.0))) / max(n * (n - 1.0), 1.0)
    if n < 2 or not 0 < chance < 1:
        return None
    shuffled = np.random.default_rng(n).permutation(n)
    order = shuffled[np.argsort(record.prints[shuffled], kind="stable")]
    prints, calls = record.prints[order], record.calls[order]
    equal = prints[1:] == prints[:-1]
    first = equal & ~np.concatenate([[False], equal[:-1]])  # the first pair of every value that occurs more than once
    pairs = int(np.count_nonzero(first))
    if pairs < 2:
        return None
    together = int(np.count_nonzero(calls[1:][first] == calls[:-1][first]))
    p = binomial_p(together, pairs, chance, chance)
    rejected = p <= alpha
    message = (
        f"{pairs} values occur more than once in {n}, {together} of them in one call, by chance {chance * pairs:.3g}"
    )
    outcome: Outcome = "rejected" if rejected else "not rejected"
    effect = together / pairs - chance
    return Finding(name, outcome, message, p, alpha, False, together, effect, cause="correlation" if rejected else "")


def repeated_stretches(name: str, record: Succession) -> Finding | None:
    """Return whether stretches of 64 realisations occur twice, where chance alone would not explain one; else None."""
    alike = (record.alike + 1) / (int(record.pairs[0]) + 1)
    windows = len(record.windows)
    chance = 0.5 * windows**2 * alike ** (WINDOW - 4)
    if windows < 2 or chance > _CHANCE:
        return None
    repeats = windows - len(np.unique(record.windows))
    if repeats == 0:
        return Finding(name, "not rejected", f"no two of {windows} stretches of {WINDOW} realisations are equal")
    message = f"{repeats} of {windows} stretches of {WINDOW} realisations occurred before: a stream that starts again"
    return Finding(name, "rejected", message, effect=repeats / windows, cause="repeated samples")
