"""Scattering orders: what has scattered n times is the n-th coefficient of the solution as a power series in the albedo.

Cauchy's integral over a circle in the complex plane of albedos gives all coefficients at once; in N points it is off by
the coefficients N, 2 N, … further up, times powers of the radius.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
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
    first: np.ndarray | None = None,
    most: np.ndarray | None = None,
) -> Reference:
    """Return the coefficients 0 … count of a power series, (..., count + 1).

    solution  complex albedos (N,) of magnitude below 1 -> (..., N), real on the real axis
    known     the same at a real albedo, with its error: what the solution is off by there, it is taken to be everywhere
    first     (...) the coefficient 0, if it is known: what the solution gets wrong of it counts as its error for all of them
    most      (...) what the others are at most, if that is known; they are never negative

    Error: radius^N from the coefficients not resolved, and ten times that of the solution, over radius^n.
    """
    if most is not None and first is not None and np.all(most <= EXPECTED):
        others = np.repeat(most[..., None], count, axis=-1) / 2
        return _with_first(first, others, others, METHOD, source)
    points = 64 + 2 * count
    largest = EXPECTED ** (1 / (points + count))
    value, error = _on_a_circle(solution, count, points, largest, known, first)
    if most is not None:
        low, high = np.maximum(value - error, 0.0), np.minimum(value + error, most[..., None])
        error = np.where(high < low, error, (high - low) / 2)
        value = np.where(high < low, value, low + error)
    if first is None:
        return Reference(value, error, METHOD, source)
    return _with_first(first, value[..., 1:], error[..., 1:], METHOD, source)


def _with_first(first: np.ndarray, value: np.ndarray, error: np.ndarray, method: str, source: str) -> Reference:
    exact = first[..., None]
    return Reference(
        np.concatenate([exact, value], axis=-1),
        np.concatenate([8 * EPS * exact, error + TINY], axis=-1),
        method,
        source,
    )


def _on_a_circle(
    solution: Callable[[np.ndarray], np.ndarray],
    count: int,
    points: int,
    radius: float,
    known: Callable[[float], Reference],
    first: np.ndarray | None,
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
        if first is not None:
            error = np.maximum(error, np.abs(series[..., 0] - first)[..., None])
        shrink = radius ** -np.arange(count + 1.0)
        unseen = radius**points
        aliased = unseen / (1 - unseen)
        return series * shrink, (10 * error + 8 * EPS * size) * shrink + aliased
