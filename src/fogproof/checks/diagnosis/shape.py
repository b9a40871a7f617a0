"""What remains of a misfit that no named cause explains: a law a little off anywhere, in cells, by level, along axes."""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.diagnosis.contrast import Contrast

_CELLS = (16, 64, 256)
_LEVELS = (4, 16, 64)  # of the odds that a point is a sample
_RIDGE = 1e-9
_NEW = 1e-6  # share of its variance that a wave has for itself
_MOST = 3.0  # logarithm of a factor that a wave is trusted with


def unexplained(contrast: Contrast, s: np.ndarray) -> float:
    """Return the log-likelihood that the best of some general corrections to a density adds, their parameters paid for.

    s  values of the density (n + m,) at all points, samples first

    A correction is a factor in some cells, one at some levels of the density, or the exponential of some waves, along the axes or
    products of two. Each parameter costs what Schwarz's criterion (1978) says, and what choosing it among all costs besides.
    """
    at, odds = contrast.likelihood(s), contrast.odds(s)
    w = odds / (1 + odds)
    n, price = len(contrast.x), _price(contrast)
    most, cells = 0.0, int(contrast.cell.max()) + 1
    rank = np.empty(len(odds), dtype=np.intp)
    mixed = np.random.default_rng(0).permutation(len(odds))  # of equal odds, samples are not the first
    rank[mixed[np.argsort(odds[mixed], kind="stable")]] = np.arange(len(odds))
    groups = [contrast.cell * k // cells for k in _CELLS if k <= cells] + [rank * k // len(odds) for k in _LEVELS]
    for group in groups:
        all_of, expected = np.bincount(group), np.bincount(group, w)
        seen = np.bincount(group[:n], minlength=len(all_of))
        factor = np.log((seen + 1) / (expected + 1)) - np.log((all_of - seen + 1) / (all_of - expected + 1))
        each = price + math.log(len(factor))
        telling = 0.5 * (seen - expected) * factor > each
        if telling.any():
            gain = contrast.likelihood(s * np.exp(np.where(telling, factor, 0.0))[group]) - at
            most = max(most, gain - each * np.count_nonzero(telling))
    waves, variance = contrast.waves, w * (1 - w)
    score, information = waves[:n].sum(axis=0) - waves.T @ w, waves.T @ (waves * variance[:, None])
    information += _RIDGE * np.trace(information) * np.eye(len(score))
    price = unseen(contrast)
    kept = _telling(score, information, price)
    factor = np.clip(waves[:, kept] @ np.linalg.solve(information[np.ix_(kept, kept)], score[kept]), -_MOST, _MOST)
    return max(most, contrast.likelihood(s * np.exp(factor)) - at - price * (len(kept) - 1))


def unseen(contrast: Contrast) -> float:
    """Return the log-likelihood which even the best correction by one parameter may add without being seen."""
    return _price(contrast) + math.log(contrast.waves.shape[1])


def _price(contrast: Contrast) -> float:
    return 0.5 * math.log(len(contrast.x))


def _telling(score: np.ndarray, information: np.ndarray, price: float) -> list[int]:
    """Return which waves, beside the constant, gain more than their price each, the one that gains most first (Rao 1948).

    score        (k,) derivative of the log-likelihood
    information  (k, k) its covariance: what is chosen is taken out of the others, as by elimination
    """
    score, left, kept = score.copy(), information.copy(), [0]
    while True:
        pivot = kept[-1]
        share = left[:, pivot] / left[pivot, pivot]
        score, left = score - share * score[pivot], left - np.outer(share, left[pivot])
        spread = np.diag(left)
        gain = np.where(spread > _NEW * np.diag(information), 0.5 * score**2 / np.maximum(spread, 1e-300), 0.0)
        gain[kept] = 0.0
        if gain.max() <= price:
            return kept
        kept.append(int(np.argmax(gain)))
