"""Rayleigh scattering of unpolarised light (Rayleigh 1871): 3/(16 pi) (1 + mu^2).

The cdf (mu^3 + 3 mu + 4)/8 is inverted by the one real root of a depressed cubic (Cardano): with s = 4 xi - 2,
w = cbrt(s + sqrt(s^2 + 1)) and mu = w - 1/w.
"""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernels.path_data import RAYLEIGH, Lobe
from fogproof.estimators.phase.polar import Polar
from fogproof.scene import Rayleigh


def density(phase: Rayleigh, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]."""
    mu = 0.5 * (coversine - versine)
    return 3 / (16 * np.pi) * (1 + mu * mu)


def cosines(phase: Rayleigh, xi: np.ndarray, out: np.ndarray) -> None:
    """Write forward cosines, absolute error below 10 eps, so at the ends a rounding beyond them."""
    s = 4 * xi
    s -= 2
    w = s * s
    w += 1
    np.sqrt(w, out=w)
    w += s
    np.cbrt(w, out=w)
    np.divide(1, w, out=s)
    np.subtract(w, s, out=out)


def polar(phase: Rayleigh, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf.

    With v = 1 - mu the cdf reads 8 (1 - xi) = v (6 - 3 v + v^2): one step of this fixed point gives v its relative precision at
    the pole, where the cubic's root has only the absolute one; the same holds for 1 + mu and xi.
    """
    mu = np.empty_like(xi)
    cosines(phase, xi, mu)
    versine, coversine = 1 - mu, 1 + mu
    versine = 8 * (1 - xi) / (6 - versine * (3 - versine))
    coversine = 8 * xi / (6 - coversine * (3 - coversine))
    return Polar(versine, coversine, 3 / (16 * np.pi) * (1 + mu * mu))


def lobe(_phase: Rayleigh) -> Lobe:
    """Return it for compiled kernels."""
    return Lobe(RAYLEIGH, 0.0)
