"""Hazy and murky atmospheres (after Nishita, Miyawaki & Nakamae 1987): (1/2 + (n + 1)/2 u^n)/(4 pi), u = (1 + mu)/2.

Half of the light is isotropic, u uniform; the other half has u = xi^(1/(n + 1)). One uniform serves both the choice and the
value: |2 xi - 1| is exact and uniform in either half. n is a power of two.
"""

from __future__ import annotations

import numpy as np

from fogproof.estimators.phase.polar import Polar


def density(n: int, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]."""
    power = 0.5 * coversine
    for _ in range(n.bit_length() - 1):  # n is a power of two
        power *= power
    power *= (n + 1) / (8 * np.pi)
    power += 1 / (8 * np.pi)
    return power


def cosines(n: int, xi: np.ndarray, out: np.ndarray) -> None:
    """Write forward cosines: u = v^1 or v^(1/(n + 1)), whichever half xi lies in, by one exponential for both."""
    v = 2 * xi
    v -= 1
    power = np.sign(v)
    power *= -0.5 * n / (n + 1)
    power += 1 - 0.5 * n / (n + 1)
    np.abs(v, out=v)
    with np.errstate(divide="ignore"):
        np.log(v, out=v)
    v *= power
    np.exp(v, out=v)
    np.multiply(v, 2, out=out)
    out -= 1


def polar(n: int, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf."""
    u = 2 * xi - 1
    lobe = u >= 0
    u = np.abs(u)
    with np.errstate(divide="ignore"):
        log = np.log(u) / (n + 1)
    coversine = 2 * np.where(lobe, np.exp(log), u)
    versine = np.where(lobe, -2 * np.expm1(log), 2 * (1 - u))
    return Polar(versine, coversine, density(n, coversine))
