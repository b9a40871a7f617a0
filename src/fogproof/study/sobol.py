"""Scrambled Sobol points (Owen's scrambling of a digital net) in the place of a generator's numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.errors import SubjectError


class SobolPoints:
    """Gives an estimator that is a pure function of uniforms its points (n, dimensions), column by column.

    It has the one method of `numpy.random.Generator` that such an estimator calls.
    """

    def __init__(self, points: np.ndarray) -> None:
        self._points = points
        self._used = 0

    @staticmethod
    def sequence(dimensions: int, rng: np.random.Generator, start: int) -> Any:
        """Return a scrambled sequence that goes on at point `start`."""
        from scipy.stats import qmc

        sequence = qmc.Sobol(dimensions, scramble=True, rng=rng)
        return sequence.fast_forward(start) if start else sequence

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
