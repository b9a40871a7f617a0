"""Phase functions that are polynomials in mu, hence sums of cosines of the angle: values and sampling.

With f(theta) = sum_k a_k cos(k theta) the share up to an angle is a sum of cosines as well, and is inverted by Newton's method
between bounds that bisection narrows. Long sums are taken from `CosinePieces`: what a thousand terms are costs as much as sixteen.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev

from fogproof.estimators.inversion import inverted
from fogproof.estimators.phase.polar import Polar

FEWEST_CELLS = 4096
"""Of the grid of angles from which Newton's method starts: three steps are then enough."""

TERMS = 16
"""Of each polynomial in `CosinePieces`: over an angle pi/m, cos(m theta) is one of fifteenth degree but for J_16(pi/2) < 1e-15."""


@dataclass(frozen=True, eq=False)
class CosinePieces:
    """A sum of at most m cosines of an angle in [0, pi], as polynomials in m equal pieces of it.

    coefficients  (TERMS, m) of Chebyshev polynomials in each piece
    """

    coefficients: np.ndarray

    @staticmethod
    def of(a: np.ndarray) -> CosinePieces:
        """Interpolate sum_k a_k cos(k theta) at Chebyshev nodes of each piece: a Fourier transform has one node of all pieces."""
        m, k = len(a), np.arange(len(a))
        node = np.cos(np.pi * (np.arange(TERMS) + 0.5) / TERMS)
        at = [2 * m * np.fft.ifft(a * np.exp(0.5j * np.pi * (1 + c) / m * k), 2 * m).real[:m] for c in node]
        turned = np.cos(np.pi * np.arange(TERMS)[:, None] * (np.arange(TERMS) + 0.5) / TERMS)
        turned[0] /= 2
        return CosinePieces(2 / TERMS * turned @ np.array(at))

    def __call__(self, theta: np.ndarray) -> np.ndarray:
        """Return f by Clenshaw's recurrence."""
        m = self.coefficients.shape[1]
        place = theta * (m / np.pi)
        piece = np.clip(place.astype(np.intp), 0, m - 1)
        x = 2 * (place - piece) - 1
        last, one = np.zeros_like(x), np.zeros_like(x)
        for row in self.coefficients[:0:-1]:
            last, one = one, row[piece] + 2 * x * one - last
        return self.coefficients[0][piece] + x * one - last


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
    def _value(self) -> Callable[[np.ndarray], np.ndarray]:
        """The density by angle [1/sr]."""
        return _by_angle(self.coefficients)

    @cached_property
    def _share(self) -> Callable[[np.ndarray], np.ndarray]:
        """The share beyond an angle."""
        return _by_angle(chebyshev.chebint(2 * np.pi * self.coefficients, lbnd=-1))

    @cached_property
    def _grid(self) -> tuple[np.ndarray, np.ndarray]:
        """Angles from pi to 0, and the share beyond each."""
        cells = max(FEWEST_CELLS, 8 * self.values.size)
        theta = np.pi * (1 - np.arange(cells + 1) / cells)
        return theta, np.maximum.accumulate(np.clip(self._share(theta), 0, 1))

    def density(self, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
        """Return f at 1 - mu and 1 + mu [1/sr]; error some eps times its greatest value."""
        theta = 2 * np.arctan2(np.sqrt(versine.astype(np.float64)), np.sqrt(coversine.astype(np.float64)))
        return np.maximum(self._value(theta), 0).astype(versine.dtype)

    def polar(self, xi: np.ndarray) -> Polar:
        """Return scattering angles and their pdf."""
        theta, share = self._grid
        target = xi.astype(np.float64)
        cell = np.clip(np.searchsorted(share, target, side="right"), 1, len(share) - 1)
        high, low = theta[cell - 1], theta[cell]
        inside = (target - share[cell - 1]) / np.maximum(share[cell] - share[cell - 1], 1e-300)
        at = high - (high - low) * np.clip(inside, 0, 1)

        def beyond(t: np.ndarray, which: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            slope = 2 * np.pi * np.sin(t) * np.maximum(self._value(t), 1e-300)
            return target[which] - self._share(t), np.maximum(slope, 1e-300)

        at = inverted(beyond, at, low, high, unit=np.pi)
        versine, coversine = 2 * np.sin(at / 2) ** 2, 2 * np.cos(at / 2) ** 2
        return Polar(
            versine.astype(xi.dtype), coversine.astype(xi.dtype), self.density(versine, coversine).astype(xi.dtype)
        )


def _by_angle(a: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """Return sum_k a_k cos(k theta) as a function of theta."""
    if len(a) > 2 * TERMS:
        return CosinePieces.of(a)
    return lambda theta: chebyshev.chebval(np.cos(theta), a)
