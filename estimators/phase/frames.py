"""Directions about an axis, without loss at the poles."""

from __future__ import annotations

import math

import numpy as np

Axis = tuple[float, float, float]


def turn(axis: Axis, versine: np.ndarray, coversine: np.ndarray, u_phi: np.ndarray, out: np.ndarray) -> np.ndarray:
    """Write to `out` (n, 3) the unit vectors at forward cosine mu about `axis` and azimuth 2 pi u_phi, and return it.

    versine    (n,) 1 - mu
    coversine  (n,) 1 + mu

    Sine and cosine of the azimuth are rational in the tangent of its half, several times faster than the functions themselves.
    """
    mu = coversine - versine
    mu *= 0.5
    sine = versine * coversine
    np.sqrt(sine, out=sine)
    y = np.pi * u_phi
    np.tan(y, out=y)
    x = y * y
    x += 1
    sine /= x  # sin theta / (1 + t^2), t the tangent
    y *= sine
    y *= 2
    np.subtract(2, x, out=x)
    x *= sine
    _reflect(axis, (x, y, mu), sine, out)
    return out


def _reflect(
    axis: Axis, local: tuple[np.ndarray, np.ndarray, np.ndarray], scratch: np.ndarray, out: np.ndarray
) -> None:
    """Take directions about +z to directions about `axis`, by the reflection that takes +z to it.

    Householder 1958, on the plane between -z and the axis, or +z and the axis, whichever is the farther apart: no cancellation
    for any axis. It turns the azimuth around, which is uniform.
    """
    if axis == (0.0, 0.0, 1.0):
        for i in range(3):
            out[:, i] = local[i]
        return
    sign = math.copysign(1.0, axis[2])
    v = (axis[0], axis[1], axis[2] + sign)
    share = 1 / (1 + abs(axis[2]))  # 2 / |v|^2
    along = local[2] * (v[2] * share)
    for i in range(2):
        np.multiply(local[i], v[i] * share, out=scratch)
        along += scratch
    for i in range(3):
        np.multiply(along, v[i], out=scratch)
        first, second = (scratch, local[i]) if sign > 0 else (local[i], scratch)
        np.subtract(first, second, out=out[:, i])


def half_chord_square(x: np.ndarray, axis: Axis) -> np.ndarray:
    """Return |x - axis|^2 / 2 (n,): 1 - mu for unit vectors x (n, 3), with relative precision near the axis."""
    total = np.zeros(len(x))
    for i in range(3):
        difference = x[:, i] - axis[i]
        difference *= difference
        total += difference
    total *= 0.5
    return total
