"""What tests on counted cells share: what they may miss, what rounding hides, blocks of cells, and words for where a cell lies.

A difference that the error of the expected masses or the rounding of points alone could explain never rejects.
"""

from __future__ import annotations

import numpy as np

from fogproof.checks.density.grid import Marginal
from fogproof.checks.verdict import Finding

MISS = 0.01
"""Every resolution is stated for this probability of missing the error."""

HIDDEN = 0.5
"""Root mean square of the ratio of densities less 1: where rounding could explain so much, seeing nothing is no pass."""

EXPLAINED = "; rounding explains any difference there could be: nothing can be told"
"""What is said where single precision leaves nothing to see."""
BLURRED = 0.1  # standard deviations of a count: an expectation known less well makes a test inconclusive
_ENDLESS = 1e300  # ends beyond are those of numbers, not of a domain: nobody wants to read them
EXACT = 0.01  # standard deviations: an expectation known better leaves p-values uniform


def below(marginal: Marginal, edge: int) -> str:
    """Return in words which part of the axis lies before an edge."""
    sign = "<" if marginal.shown[-1] > marginal.shown[0] else ">"
    return f"{marginal.label} {sign} {marginal.shown[edge]:.5g}"


def between(marginal: Marginal, first: int, last: int) -> str:
    """Return in words which part of the axis lies between two edges."""
    low, high = sorted((marginal.shown[first], marginal.shown[last]))
    least, most = f"{low:.6g} < " if low > -_ENDLESS else "", f" < {high:.6g}" if high < _ENDLESS else ""
    return f"{least}{marginal.label}{most}"


def unevenness(cells: int) -> str:
    """Return the name of the misfit that a chi-square on so many cells sees."""
    return f"misfit that is even in each of {cells} cells (root mean square of the ratio of densities less 1)"


def drowned(n: float, mass: np.ndarray, blur: np.ndarray) -> bool:
    """Return whether rounding may move more samples in and out of most cells than chance does."""
    return bool(n * np.mean(blur**2 / np.maximum(mass, 1e-300)) > 1)


def blocks(values: np.ndarray, size: int) -> np.ndarray:
    """Return the sums of square blocks of (n, n) values, (size, size); neighbours are added while that halves their number."""
    while len(values) >= 2 * size and len(values) % (2 * size) == 0:
        values = values[::2] + values[1::2]
        values = values[:, ::2] + values[:, 1::2]
    if len(values) == size:
        return values
    step = len(values) // size
    return np.asarray(values.reshape(size, step, size, step).sum(axis=(1, 3)))


def nothing_counted(name: str, alpha: float) -> Finding:
    """Return what is to be said where no sample belongs to the continuous part."""
    return Finding(name, "inconclusive", "no sample belongs to the continuous part", alpha=alpha)
