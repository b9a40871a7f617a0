"""One stretch of a line is wrong by itself: a layer of a ziggurat, a segment of a tabulated cdf, an inverse of its own.

It keeps its probability, and so nothing outside of it moves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import numpy as np

from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.holes import along_a_line
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting

_CELLS, _PER_CELL = 512, 64  # most, and samples of each at least
_PRICE = 1.0  # of log-likelihood that a cell of the stretch must gain: by chance it gains half
_MOST = 0.8  # of the probability
_CHANCE = 4.0  # standard errors of a probability that is the same
_UNBALANCED = 0.15  # of what is gathered: from everywhere it would lack more beyond a stretch of the most probability
_BALANCED = 0.5  # standard errors of a probability, where a stretch ends
_GROUPS, _MISFIT = 24, 5.0  # of cells outside, and standard deviations of their chi-square that are no chance
_FEWEST = 4  # rates that describe a stretch


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield that the samples differ from the claim in one stretch alone, where as many lie as should.

    In cells of about equal claimed probability, the stretch has the greatest sum of what each gains by a rate of its own, less a
    price: a maximum of differences of one sequence.
    """
    n = len(setting.contrast.x)
    x, z = _coordinate(setting, setting.contrast.x), _coordinate(setting, setting.contrast.z)
    weight = np.maximum(setting.values[n:], 0.0) / setting.contrast.q[n:]
    cells = min(_CELLS, n // _PER_CELL)
    order = np.argsort(z)
    share = np.cumsum(weight[order])
    if not share[-1] > 0:
        return
    weight = weight * n / share[-1]
    inner = np.interp(np.arange(1, cells) * share[-1] / cells, share, z[order])
    at_x, at_z = np.searchsorted(inner, x), np.searchsorted(inner, z)
    seen, expected = np.bincount(at_x, minlength=cells), np.bincount(at_z, weight, cells)
    variance = expected + np.bincount(at_z, weight**2, cells)
    sums = np.concatenate([[0.0], np.cumsum(0.5 * (seen - expected) ** 2 / np.maximum(variance, 1.0) - _PRICE)])
    last = int(np.argmax(sums - np.minimum.accumulate(sums)))
    first = int(np.argmin(sums[: last + 1]))
    first, last = _balanced(first, last, np.concatenate([[0.0], np.cumsum(seen - expected)]), variance)
    here = slice(first, last)
    outside = np.r_[0:first, last:cells]
    if not (_FEWEST <= last - first <= _MOST * cells and _fit((seen - expected)[outside], variance[outside])):
        return
    edges = np.concatenate([[0.0], inner, [1.0]])[first : last + 1]
    where = along_a_line(setting, float(edges[0]), float(edges[-1]))
    words = f"these samples fit the pdf but in {where}: {seen[here].sum() / n:.2g} of them lie there, as should, in other places"
    for groups in sorted({_FEWEST, _telling(seen[here], expected[here], variance[here], math.log(n))}):
        group = np.arange(last - first) * groups // (last - first)
        rate = np.bincount(group, seen[here]) / np.maximum(np.bincount(group, expected[here]), 1e-300)
        yield Hypothesis(
            "displaced stretch",
            f"{words}, as of one layer of a ziggurat, or one segment of a table",
            partial(_with_rates, edges, rate[group]),
            fitted=groups,
            loose=True,
        )


def _balanced(first: int, last: int, excess: np.ndarray, variance: np.ndarray) -> tuple[int, int]:
    """Return a stretch with as many samples as expected, from one that may only have what is gathered, or only what it lacks.

    excess  (k + 1,) of samples before each edge of a cell

    The other part lies before the stretch or behind it: the nearer is meant.
    """
    lack, error = float(excess[last] - excess[first]), math.sqrt(float(variance[first:last].sum()))
    if abs(lack) <= _CHANCE * error:
        return first, last
    before = np.flatnonzero((excess[last] - excess[:first]) * np.sign(lack) <= _BALANCED * error)
    behind = np.flatnonzero((excess[last + 1 :] - excess[first]) * np.sign(lack) <= _BALANCED * error)
    ends = [(int(before[-1]), last)] if len(before) else []
    ends += [(first, last + 1 + int(behind[0]))] if len(behind) else []
    if (
        not ends
    ):  # at an end of the axis but for chance: what is gathered from everywhere lacks more than that elsewhere
        for low, high in ((0, last), (first, len(variance))):
            most = min(_CHANCE * math.sqrt(float(variance[low:high].sum())), _UNBALANCED * abs(lack))
            ends += [(low, high)] * (abs(float(excess[high] - excess[low])) <= most)
    return min(ends, key=lambda end: end[1] - end[0], default=(0, 0))


def _fit(excess: np.ndarray, variance: np.ndarray) -> bool:
    """Return whether the excess in cells (k,) is chance, in some groups of them."""
    group = np.arange(len(excess)) * _GROUPS // max(len(excess), 1)
    chi_square = np.sum(np.bincount(group, excess) ** 2 / np.maximum(np.bincount(group, variance), 1.0))
    return bool(chi_square < _GROUPS + _MISFIT * math.sqrt(2 * _GROUPS))


def _telling(seen: np.ndarray, expected: np.ndarray, variance: np.ndarray, price: float) -> int:
    """Return into how many groups of cells, each with a rate of its own, a stretch of cells (k,) is divided best."""
    k = len(seen)
    gains = {}
    for groups in {min(_FEWEST << power, k) for power in range(k.bit_length())}:
        group = np.arange(k) * groups // k
        excess, spread = np.bincount(group, seen - expected), np.bincount(group, variance)
        gains[groups] = float(np.sum(0.5 * excess**2 / np.maximum(spread, 1.0))) - 0.5 * price * groups
    return max(gains, key=lambda groups: gains[groups])


def _with_rates(edges: np.ndarray, rate: np.ndarray, setting: Setting, _: float) -> Density:
    """Return the claim times a rate (k,) between each two of k + 1 edges, and as it is beyond them."""
    factor = np.concatenate([[1.0], rate, [1.0]])
    return lambda x: setting.p(x) * factor[np.searchsorted(edges, _coordinate(setting, x))]


def _coordinate(setting: Setting, x: np.ndarray) -> np.ndarray:
    return setting.law.coordinates(x, np.full((len(x), 1), 0.5))[:, 0]
