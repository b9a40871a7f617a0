"""Kolmogorov's distance between counts along an axis and the cdf, judged by Massart's inequality."""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.density.grid import Marginal
from fogproof.checks.statistics.cells import BLURRED, EXPLAINED, MISS, below, nothing_counted
from fogproof.checks.verdict import EffectInterval, Finding, Outcome, Resolution

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
    blurred = bool(np.max(marginal.error) * math.sqrt(n) > BLURRED)
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
