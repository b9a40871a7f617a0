"""Orthonormal frames and directions about an axis, without loss at the poles."""

from __future__ import annotations

import numpy as np

Axis = tuple[float, float, float]


def tangents(axis: Axis) -> tuple[np.ndarray, np.ndarray]:
    """Return two unit vectors that make a right-handed frame with the unit vector `axis`.

    Duff et al. 2017, "Building an Orthonormal Basis, Revisited": continuous but at z = 0, and free of cancellation.
    """
    x, y, z = axis
    sign = float(np.copysign(1.0, z))
    a = -1.0 / (sign + z)
    b = x * y * a
    return np.array([1 + sign * x * x * a, sign * b, -sign * x]), np.array([b, sign + y * y * a, -y])


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
    half = np.pi * u_phi
    np.tan(half, out=half)
    square = half * half
    square += 1
    sine /= square  # sin theta / (1 + t^2), t the tangent
    half *= sine
    half *= 2
    square -= 2
    square *= sine  # -cos phi sin theta
    if axis == (0.0, 0.0, 1.0):
        out[:, 2] = mu
        out[:, 1] = half
        np.negative(square, out=out[:, 0])
        return out
    t1, t2 = tangents(axis)
    for i in range(3):
        np.multiply(mu, axis[i], out=sine)
        sine += half * float(t2[i])
        sine -= square * float(t1[i])
        out[:, i] = sine
    return out


def half_chord_square(x: np.ndarray, axis: Axis) -> np.ndarray:
    """Return |x - axis|^2 / 2 (n,): 1 - mu for unit vectors x (n, 3), with relative precision near the axis."""
    total = np.zeros(len(x))
    for i in range(3):
        difference = x[:, i] - axis[i]
        difference *= difference
        total += difference
    total *= 0.5
    return total
