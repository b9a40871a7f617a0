"""Scattering orders: what has scattered n times is the n-th coefficient of the solution as a power series in the albedo.

Cauchy's integral over a circle in the complex plane of albedos gives all coefficients at once; in N points it is off by
the coefficients N, 2 N, … further up, times powers of the radius.
"""

from __future__ import annotations

from collections.abc import Callable

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
) -> Reference:
    """Return the coefficients 0 … count of a power series, (..., count + 1).

    solution  complex albedos (N,) of magnitude below 1 -> (..., N), real on the real axis, with coefficients in [0, 1]
    known     the same at a real albedo, with its error: what the solution is off by there, it is taken to be everywhere

    Error: radius^N from the coefficients not resolved, and ten times that of the solution, over radius^n.
    """
    points = 64 + 2 * count
    radius = EXPECTED ** (1 / (points + count))
    half = np.arange(points // 2 + 1)
    with np.errstate(under="ignore", over="ignore", divide="ignore"):
        values = solution(radius * np.exp(2j * np.pi * half / points))
    there = known(radius)
    error = (np.abs(np.real(values[..., 0]) - there.value) + there.error)[..., None]
    series = np.fft.irfft(np.conj(values), points, axis=-1)[..., : count + 1]
    shrink = radius ** -np.arange(count + 1.0)
    aliased = radius**points / (1 - radius**points)
    return Reference(series * shrink, (10 * error + 8 * EPS) * shrink + aliased, METHOD, source)
