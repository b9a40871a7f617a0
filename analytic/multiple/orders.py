"""Scattering orders: what has scattered n times is the n-th coefficient of the solution as a power series in the albedo.

Cauchy's integral over a circle in the complex plane of albedos gives all coefficients at once; in N points it is off by
the coefficients N, 2 N, … further up, times powers of the radius.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.contracts import Reference

METHOD = "Cauchy's integral in the complex plane of albedos"

EXPECTED = 1e-13
"""Error of a solution that the radius of the circle is made for; a larger one costs accuracy, not honesty."""


def taylor_coefficients(
    solution: Callable[[np.ndarray], np.ndarray],
    count: int,
    *,
    known: Callable[[float], Reference],
    source: str,
    shares: Sequence[float] = (1.0,),
    growth: float = 1.0,
) -> Reference:
    """Return the coefficients 0 … count of a power series, (..., count + 1).

    solution  complex albedos (N,) of magnitude below 1/growth -> (..., N), real on the real axis
    known     the same at a real albedo, with its error: what the solution is off by there, it is taken to be everywhere
    shares    of the radius at which to look too: the first coefficients may be much smaller than the others, and on a
              small circle so is the error; each coefficient is taken from where its error is least
    growth    the n-th coefficient is in [0, growth^(n - 1)]: the chance at most that what has scattered collides again

    Error: radius^N from the coefficients not resolved, and ten times that of the solution, over radius^n.
    """
    points = 64 + 2 * count
    largest = EXPECTED ** (1 / (points + count)) / growth
    found = [_on_a_circle(solution, count, points, largest * share, growth, known) for share in shares]
    value, error = found[0]
    for other, its_error in found[1:]:
        value, error = np.where(its_error < error, other, value), np.minimum(its_error, error)
    return Reference(value, error, METHOD, source)


def _on_a_circle(
    solution: Callable[[np.ndarray], np.ndarray],
    count: int,
    points: int,
    radius: float,
    growth: float,
    known: Callable[[float], Reference],
) -> tuple[np.ndarray, np.ndarray]:
    """Return the coefficients from a circle, and their errors."""
    half = np.arange(points // 2 + 1)
    with np.errstate(under="ignore", over="ignore", divide="ignore"):
        values = solution(radius * np.exp(2j * np.pi * half / points))
    there = known(radius)
    error = (np.abs(np.real(values[..., 0]) - there.value) + there.error)[..., None]
    size = np.max(np.abs(values), axis=-1, keepdims=True)
    with np.errstate(under="ignore"):
        series = np.fft.irfft(np.conj(values), points, axis=-1)[..., : count + 1]
        shrink = radius ** -np.arange(count + 1.0)
        unseen = (radius * growth) ** points
        aliased = unseen / (1 - unseen) * growth ** np.maximum(np.arange(count + 1.0) - 1, 0)
        return series * shrink, (10 * error + 8 * EPS * size) * shrink + aliased
