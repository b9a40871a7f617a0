"""The label test: given the point, the label is a coin whose bias is known.

Samples of an unknown law and points of a known one are mixed by coin tosses. If the samples have the density p, a point at z is a
sample with probability w = p / (p + r q), exactly, whatever p is and in any dimension: the residual "label - w" has mean 0 and
variance w (1 - w), without one integral. Its sum over everything tests normalisation, sums over the cells of a tree test the shape,
sums over levels of w test whether the places that p makes likely are.

A classifier two-sample test turned round (Lopez-Paz & Oquab 2017): the classifier is the claim itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fogproof.checks.statistics.cells import MISS, unevenness
from fogproof.checks.statistics.integrated import Integrated
from fogproof.checks.statistics.label_scores import scores
from fogproof.checks.statistics.label_strips import Strips, strips
from fogproof.checks.statistics.residuals import LEAST, chi_square, detected, sums_in
from fogproof.checks.statistics.tails import normal_quantile
from fogproof.checks.verdict import Finding, Outcome, Resolution

_EDGES = np.array([-4.0, -2.0, *np.arange(-1.0, 1.01, 0.25), 2.0, 4.0])  # of the levels, in log(w / (1 - w))
LEVELS = len(_EDGES) + 1
_NORMAL = 50.0  # variance from which on a sum's tail is the normal one, corrected for skewness
_SKEW = 0.5  # largest exponent of that correction
_THIRD = 0.3  # of the samples of a cell: a level at which more would have to be missing is too fine to speak of
_WRONG = 5.0  # standard errors by which an integral must be off to be the cause
_TELLING = 100.0  # variance of all residuals: with less, nothing is said


@dataclass(frozen=True)
class Sums:
    """Sums over points: of residuals, of their variances, of their third moments, of their squared variances; (4, m) each.

    cells   one column a leaf of the tree
    levels  one column a level of w
    integral  (5,) of p, by the points of the known law alone, see `Integrated`
    score   (q,) of residuals weighed with smooth functions of the point
    spread  (2, q + 1, q + 1) what they are measured by, see `Basis.weighed`
    strips  (4, r, 256) one row an axis or pair of axes, see `Strips`
    """

    cells: np.ndarray
    levels: np.ndarray
    integral: np.ndarray
    score: np.ndarray
    spread: np.ndarray
    strips: np.ndarray

    @staticmethod
    def of(
        labels: np.ndarray,
        w: np.ndarray,
        cell: np.ndarray,
        cells: int,
        integral: np.ndarray,
        weighed: tuple[np.ndarray, np.ndarray, np.ndarray],
    ) -> Sums:
        """Return the sums over points with labels (n,) of 0 or 1, probabilities w (n,), in the given cells (n,).

        weighed  score, spread and strips
        """
        with np.errstate(divide="ignore"):
            level = np.searchsorted(_EDGES, np.log(w) - np.log1p(-w))
        return Sums(
            sums_in(cell, cells, labels, w),
            sums_in(level, LEVELS, labels, w),
            integral,
            *weighed,
        )

    @property
    def columns(self) -> tuple[np.ndarray, ...]:
        """All sums."""
        return self.cells, self.levels, self.integral, self.score, self.spread, self.strips

    def merged(self, other: Sums) -> Sums:
        """Return the sums over both."""
        return Sums(*(mine + theirs for mine, theirs in zip(self.columns, other.columns, strict=True)))


def tail(total: np.ndarray, variance: np.ndarray, third: np.ndarray) -> np.ndarray:
    """Return (m,) two-sided p-values of sums of independent residuals in [-1, 1].

    With a large variance the normal law's, times exp(skewness z^3 / 6), the leading term of Cramer's expansion far in the tail;
    otherwise Bennett's bound (1962), which holds for every number of them.
    """
    from scipy.special import ndtr

    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        z = np.abs(total) / np.sqrt(variance)
        skew = np.abs(third) * z**3 / (6 * variance**1.5)
        normal = 2 * ndtr(-z) * np.exp(np.minimum(skew, 1.0))
        ratio = np.abs(total) / variance
        bennett = 2 * np.exp(-variance * ((1 + ratio) * np.log1p(ratio) - ratio))
    p = np.where((variance >= _NORMAL) & (skew <= _SKEW), normal, bennett)
    return np.where(variance > 0, np.minimum(p, 1.0), 1.0)


def whole(name: str, sums: tuple[Sums, ...], alpha: float) -> Finding:
    """The sum of all residuals: the integral of the pdf, and lost samples. `sums`, one for each convention: one must hold."""
    p, total, variance = max(_total(each) for each in sums)
    if variance < _TELLING:
        message = f"samples and points of a known law share too few places: {variance:.3g} coins in doubt"
        message += " (points that rounding may move where the pdf is another do not count)"
        return Finding(name, "inconclusive", message, p, alpha)
    spread = 1 / math.sqrt(variance)
    step = (normal_quantile(alpha / 2) + normal_quantile(MISS)) * spread
    resolution = Resolution("deviation from 1 of a constant factor on the pdf", step * (1 + step), MISS)
    rejected = p <= alpha
    off = total * spread
    message = f"labels less their probabilities sum to {off:+.2f} standard deviations"
    cause, integral = "shape", Integrated(sums[0].integral)  # a misfit moves the sum too
    if integral.why_not:
        message += f"; what the pdf integrates to is not known: {integral.why_not}"
    else:
        message += f"; by points of the known law the pdf integrates to {integral.mean:.5g} +- {integral.error:.1g}"
        off_by = abs(integral.mean - 1) / max(integral.error, 1e-300)
        cause = "normalisation" if off_by > _WRONG else cause
        if off_by > _WRONG and not rejected:
            message += f", {off_by:.1f} standard errors off: no test, as they know nothing of places that no point met"
    return Finding(
        name,
        "rejected" if rejected else "not rejected",
        message,
        p,
        alpha,
        variance >= _NORMAL and len(sums) == 1,
        total,
        -total / variance,
        resolution,
        cause=cause if rejected else "",
    )


def _total(sums: Sums) -> tuple[float, float, float]:
    total, variance, third, _ = sums.cells.sum(axis=1)
    return float(tail(total, variance, third)), float(total), float(variance)


def cells_at(name: str, depth: int, sums: tuple[Sums, ...], alpha: float) -> Finding:
    """Chi-square of the residuals in the 2^depth cells of one depth of the tree."""
    return _convention([_chi_square(name, _folded(each.cells, depth), alpha) for each in sums])


def levels(name: str, sums: tuple[Sums, ...], alpha: float) -> Finding:
    """Chi-square of the residuals in levels of w: are places as frequent as the pdf is high there?"""
    return _convention([_chi_square(name, each.levels, alpha) for each in sums])


def smooth(name: str, sums: tuple[Sums, ...], alpha: float) -> Finding:
    """Score test of the residuals along smooth functions of the point."""
    return _convention([scores(name, each.score, each.spread, alpha) for each in sums])


def along_axes(name: str, where: Strips, axes: tuple[str, ...], sums: tuple[Sums, ...], alpha: float) -> Finding:
    """Chi-squares of the residuals in strips of each axis and in squares of two."""
    return _convention([strips(name, where, axes, each.strips, alpha) for each in sums])


def _convention(findings: list[Finding]) -> Finding:
    """Return the finding under the convention that fits best: the claim is right if one of them is."""
    best = max(findings, key=lambda f: 1.0 if f.p_value is None else f.p_value)
    return replace(best, exact=best.exact and len(findings) == 1)


def _folded(cells: np.ndarray, depth: int) -> np.ndarray:
    """Return (4, 2^depth) the sums of leaves under each node of one depth."""
    return np.asarray(cells.reshape(len(cells), 1 << depth, -1).sum(axis=2))


def _chi_square(name: str, columns: np.ndarray, alpha: float) -> Finding:
    """Return the test of sums (4, m), small ones pooled."""
    if columns[1].sum() < 2 * LEAST:
        return Finding(name, "inconclusive", "too few coins are in doubt", alpha=alpha)
    p, statistic, cells = chi_square(columns)
    doubt = float(columns[1].sum())
    rejected = p <= alpha
    misfit = math.sqrt(max(statistic - cells, 0.0) / doubt)
    message = f"chi-square = {statistic:.5g} on {cells} degrees of freedom"
    outcome: Outcome = "rejected" if rejected else "not rejected"
    resolution = Resolution(unevenness(cells), detected(cells, alpha, doubt), MISS)
    cause = "shape" if rejected else ""
    return Finding(name, outcome, message, p, alpha, True, statistic, misfit, resolution=resolution, cause=cause)


def largest(name: str, describe: Callable[[int, int], str], sums: tuple[Sums, ...], alpha: float) -> Finding:
    """The most conspicuous cell of all depths; `describe(depth, number)` says in words which it is."""
    return _convention([_largest(name, describe, each, alpha) for each in sums])


def _largest(name: str, describe: Callable[[int, int], str], sums: Sums, alpha: float) -> Finding:
    depths = range(1, max(sums.cells.shape[1].bit_length(), 2))
    best, at, residual, doubt = 1.0, (0, 0), 0.0, 0.0
    for depth in depths:
        if 1 << depth > sums.cells.shape[1]:
            break
        total, variance, third, _ = _folded(sums.cells, depth)
        p = tail(total, variance, third)
        i = int(np.argmin(p))
        if p[i] * len(p) * len(depths) < best:
            best, at = float(p[i]) * len(p) * len(depths), (depth, i)
            residual, doubt = float(total[i]), float(variance[i])
    rejected = best <= alpha
    where = describe(*at)
    resolution = _reach(sums, len(depths), alpha)
    message = f"the most conspicuous cell has {residual:+.4g} samples too {'many' if residual > 0 else 'few'}"
    if not rejected:
        message = f"no cell has too many or too few samples; {message}"
    return Finding(
        name,
        "rejected" if rejected else "not rejected",
        message,
        best,
        alpha,
        False,
        residual,
        residual / max(doubt, 1.0),
        resolution,
        region=(where,) if rejected else (),
        cause="shape" if rejected else "",
    )


def _reach(sums: Sums, depths: int, alpha: float) -> Resolution | None:
    """Return the factor on the pdf that is found in any one cell, of the deepest level whose cells have coins enough.

    With V coins in doubt in a cell, samples fewer by a share s lie about s sqrt(V) standard deviations off: the pdf is then too
    large by the factor 1 / (1 - s).
    """
    for depth in range(depths, 0, -1):
        if 1 << depth <= sums.cells.shape[1]:
            z = normal_quantile(alpha / (2.0 * depths * (1 << depth))) + normal_quantile(MISS)
            share = z / math.sqrt(max(float(_folded(sums.cells, depth)[1].min()), 1e-300))
            share += 0.5 * share**2  # what the tail is wider for skewness, or for Bennett's bound
            if share <= _THIRD:
                kind = f"deviation from 1 of a factor on the pdf in one of {1 << depth} cells"
                return Resolution(kind, share / (1 - share), MISS)
    return None
