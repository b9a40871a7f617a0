"""Scrambled Sobol points (Owen 1998) in the place of a generator's numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.errors import SubjectError

BITS = 32
"""Binary digits of a point that the net sets; those behind are random, as scrambling all of them would make them.

Left at 0 they would round every uniform down by half a digit, a bias that the points are good enough to show.
"""


class SobolPoints:
    """Gives an estimator that is a pure function of uniforms its points (n, dimensions), column by column.

    It has the one method of `numpy.random.Generator` that such an estimator calls.
    """

    def __init__(self, points: np.ndarray) -> None:
        self._points = points
        self._used = 0

    def random(self, size: int | tuple[int, ...]) -> np.ndarray:
        """Return the next columns, (n,) or (n, columns)."""
        shape = (size,) if isinstance(size, int) else tuple(size)
        n, columns = len(self._points), shape[1] if len(shape) == 2 else 1
        if len(shape) not in (1, 2) or shape[0] != n or self._used + columns > self._points.shape[1]:
            wanted = (
                f"{n} x {self._points.shape[1]} uniforms were declared, {shape} asked for after {self._used} columns"
            )
            raise SubjectError(f"the estimator is no pure function of its uniforms: {wanted}", "dimensions")
        taken = self._points[:, self._used : self._used + columns]
        self._used += columns
        return np.ascontiguousarray(taken.reshape(shape))


class SobolSequence:
    """One scrambling of a Sobol sequence.

    scrambling  makes it
    behind      draws the digits that the net does not set
    start       index of the first point
    """

    def __init__(
        self, dimensions: int, scrambling: np.random.Generator, behind: np.random.Generator, start: int = 0
    ) -> None:
        from scipy.stats import qmc

        self._sequence: Any = qmc.Sobol(dimensions, scramble=True, bits=BITS, rng=scrambling)
        if start:
            self._sequence.fast_forward(start)
        self._behind = behind

    def points(self, n: int) -> SobolPoints:
        """Return the next n points."""
        u = self._sequence.random(n)
        u += 2.0**-BITS * self._behind.random(u.shape)
        return SobolPoints(np.minimum(u, 1 - 2.0**-53))
