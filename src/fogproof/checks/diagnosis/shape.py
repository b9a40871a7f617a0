"""What remains of a misfit that no named cause explains: a law that is a little off anywhere, in cells, by level, along axes."""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.diagnosis.contrast import Contrast

_CELLS = (16, 64, 256)
_LEVELS = 16  # of the odds that a point is a sample
_RIDGE = 1e-9
_MOST = 3.0  # logarithm of a factor that a wave is trusted with


def unexplained(contrast: Contrast, s: np.ndarray) -> float:
    """Return the log-likelihood that the best of some general corrections to a density adds, their parameters paid for.

    s  values of the density (n + m,) at all points, samples first

    A correction is a factor a cell, a factor a level of the density, or the exponential of waves along the axes. A parameter costs
    what Schwarz's criterion (1978) says.
    """
    at, odds = contrast.likelihood(s), contrast.odds(s)
    w = odds / (1 + odds)
    n, price = len(contrast.x), 0.5 * math.log(len(contrast.x))
    most, cells = 0.0, int(contrast.cell.max()) + 1
    rank = np.empty(len(odds), dtype=np.intp)
    rank[np.argsort(odds, kind="stable")] = np.arange(len(odds))
    groups = [contrast.cell * k // cells for k in _CELLS if k <= cells] + [rank * _LEVELS // len(odds)]
    for group in groups:
        all_of, expected = np.bincount(group), np.bincount(group, w)
        seen = np.bincount(group[:n], minlength=len(all_of))
        factor = np.log((seen + 1) / (expected + 1)) - np.log((all_of - seen + 1) / (all_of - expected + 1))
        most = max(most, contrast.likelihood(s * np.exp(factor)[group]) - at - price * len(factor))
    waves, variance = contrast.waves, w * (1 - w)
    score, information = waves[:n].sum(axis=0) - waves.T @ w, waves.T @ (waves * variance[:, None])
    information += _RIDGE * np.trace(information) * np.eye(len(score))
    factor = np.clip(waves @ np.linalg.solve(information, score), -_MOST, _MOST)
    return max(most, contrast.likelihood(s * np.exp(factor)) - at - price * len(score))
