"""Phase functions that are polynomials in mu, hence sums of cosines of the angle: values and sampling.

With f(theta) = sum_k a_k cos(k theta) the share up to an angle is a sum of cosines as well, and is inverted by Newton's method
between bounds that bisection narrows.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev

from fogproof.estimators.phase.polar import Polar

MOST_STEPS = 64

FEWEST_CELLS = 4096
"""Of the grid of angles from which Newton's method starts: three steps are then enough."""


@dataclass(frozen=True, eq=False)
class CosineSeries:
    """A density on the sphere as a sum of cosines.

    values  (m,) [1/sr] at the angles pi (j + 1/2)/m, more of them than the degree of the polynomial
    """

    values: np.ndarray

    @cached_property
    def coefficients(self) -> np.ndarray:
        """a_k, normalised."""
        m = self.values.size
        both = np.concatenate([self.values, self.values[::-1]])
        turned = np.fft.rfft(both)[:m] * np.exp(-0.5j * np.pi * np.arange(m) / m)
        a = turned.real / m
        a[0] /= 2
        even = np.arange(0, m, 2)
        return a / (4 * np.pi * float(a[::2] @ (1 / (1.0 - even * even))))

    @cached_property
    def _upto(self) -> np.ndarray:
        """Coefficients of the share with a cosine up to mu."""
        return chebyshev.chebint(2 * np.pi * self.coefficients, lbnd=-1)

    @cached_property
    def _grid(self) -> tuple[np.ndarray, np.ndarray]:
        """Angles from pi to 0, and the share beyond each."""
        cells = max(FEWEST_CELLS, 8 * self.values.size)
        theta = np.pi * (1 - np.arange(cells + 1) / cells)
        return theta, np.maximum.accumulate(np.clip(chebyshev.chebval(np.cos(theta), self._upto), 0, 1))

    def density(self, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
        """Return f at 1 - mu and 1 + mu [1/sr]; error some eps times its greatest value."""
        mu = 0.5 * (coversine.astype(np.float64) - versine)
        return np.maximum(chebyshev.chebval(mu, self.coefficients), 0).astype(versine.dtype)

    def polar(self, xi: np.ndarray) -> Polar:
        """Return scattering angles and their pdf."""
        theta, share = self._grid
        target = xi.astype(np.float64)
        cell = np.clip(np.searchsorted(share, target, side="right"), 1, len(share) - 1)
        high, low = theta[cell - 1].copy(), theta[cell].copy()
        inside = (target - share[cell - 1]) / np.maximum(share[cell] - share[cell - 1], 1e-300)
        at = high - (high - low) * np.clip(inside, 0, 1)
        left = np.arange(len(target))
        for _ in range(MOST_STEPS):
            t = at[left]
            mu = np.cos(t)
            off = chebyshev.chebval(mu, self._upto) - target[left]
            high[left], low[left] = np.where(off < 0, t, high[left]), np.where(off < 0, low[left], t)
            slope = 2 * np.pi * np.sin(t) * np.maximum(chebyshev.chebval(mu, self.coefficients), 1e-300)
            with np.errstate(divide="ignore", over="ignore"):
                step = t + off / np.maximum(slope, 1e-300)
            step = np.where((step > low[left]) & (step < high[left]), step, 0.5 * (low[left] + high[left]))
            at[left] = step
            left = left[np.abs(step - t) > 4e-16 * np.pi]
            if len(left) == 0:
                break
        versine, coversine = 2 * np.sin(at / 2) ** 2, 2 * np.cos(at / 2) ** 2
        return Polar(
            versine.astype(xi.dtype), coversine.astype(xi.dtype), self.density(versine, coversine).astype(xi.dtype)
        )
