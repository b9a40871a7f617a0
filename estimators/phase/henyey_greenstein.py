"""Henyey-Greenstein scattering (Henyey & Greenstein 1941), in a form that holds for every g in (-1, 1), 0 included.

The textbook inverse divides by 2 g and is singular at g = 0. With k = |g| and d = 1 - k + 2 k xi it is equivalent to
1 - mu = 2 (1 - k)^2 (1 - xi)(1 + k xi)/d^2 and 1 + mu = 2 (1 + k)^2 xi (1 - k + k xi)/d^2, sums of positive terms only; and the
density, a power of 1 + g^2 - 2 g mu = (1 - k^2)^2/d^2, is d^3/(4 pi (1 - k^2)^2). For g < 0 the same law is mirrored.
"""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernels.path_data import HENYEY_GREENSTEIN, ISOTROPIC, Lobe
from fogproof.estimators.phase.polar import Polar
from fogproof.scene import HenyeyGreenstein


def density(phase: HenyeyGreenstein, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]; g is the mean of mu."""
    k, from_peak = abs(phase.g), versine if phase.g >= 0 else coversine
    d2 = (1 - k) ** 2 + 2 * k * from_peak
    return (1 - k) * (1 + k) / (4 * np.pi * d2 * np.sqrt(d2))


def asymmetry_score(phase: HenyeyGreenstein, mu: np.ndarray) -> np.ndarray:
    """Return d ln f/d g at forward cosines mu."""
    g = phase.g
    score: np.ndarray = 3 * (mu - g) / (1 + g * g - 2 * g * mu) - 2 * g / (1 - g * g)
    return score


def cosines(phase: HenyeyGreenstein, xi: np.ndarray, out: np.ndarray) -> None:
    """Write forward cosines, absolute error below 10 eps.

    1 + mu = xi (c d + c (1 - k))/(c d)^2 with c = 1/(1 + k)^2: seven operations, no more than it takes.
    """
    k = abs(phase.g)
    c = 1 / (1 + k) ** 2
    if phase.g < 0:
        xi = 1 - xi
    d = xi * (2 * k * c)
    d += (1 - k) * c
    np.add(d, (1 - k) * c, out=out)
    out *= xi
    d *= d
    out /= d
    out -= 1
    if phase.g < 0:
        np.negative(out, out=out)


def polar(phase: HenyeyGreenstein, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf."""
    k = abs(phase.g)
    rest = 1 - xi
    if phase.g < 0:
        xi, rest = rest, xi
    d = 2 * k * xi
    d += 1 - k
    d2 = d * d
    from_peak = d + (1 + k)
    from_peak *= rest
    from_peak /= d2
    from_peak *= (1 - k) ** 2
    from_antipode = d + (1 - k)
    from_antipode *= xi
    from_antipode /= d2
    from_antipode *= (1 + k) ** 2
    d2 *= d
    d2 /= 4 * np.pi * ((1 - k) * (1 + k)) ** 2
    return Polar(from_peak, from_antipode, d2) if phase.g >= 0 else Polar(from_antipode, from_peak, d2)


def lobe(phase: HenyeyGreenstein) -> Lobe:
    """Return it for compiled kernels."""
    return Lobe(HENYEY_GREENSTEIN if phase.g != 0 else ISOTROPIC, phase.g)
