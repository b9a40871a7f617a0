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


def directions(axis: Axis, versine: np.ndarray, coversine: np.ndarray, u_phi: np.ndarray) -> np.ndarray:
    """Return (n, 3) unit vectors at forward cosine mu about `axis` and azimuth 2 pi u_phi.

    versine    (n,) 1 - mu
    coversine  (n,) 1 + mu

    Both are wanted because the sine is sqrt((1 - mu)(1 + mu)): from mu alone it is lost near the poles.
    """
    phi = 2 * np.pi * u_phi
    sine = np.sqrt(versine * coversine)
    mu = 0.5 * (coversine - versine)
    x, y = sine * np.cos(phi), sine * np.sin(phi)
    if axis == (0.0, 0.0, 1.0):
        return np.stack([x, y, mu], axis=-1)
    t1, t2 = tangents(axis)
    return x[:, None] * t1 + y[:, None] * t2 + mu[:, None] * np.asarray(axis)
