"""Schlick's rational stand-in for Henyey-Greenstein (Blasi, Le Saec & Schlick 1993).

With a = |k| and q = 1 - a + 2 a xi its inverse is 1 - mu = 2 (1 - a)(1 - xi)/q and 1 + mu = 2 (1 + a) xi/q, and its density
q^2/(4 pi (1 - a^2)); for k < 0 the same law is mirrored.
"""

from __future__ import annotations

import numpy as np

from fogproof.estimators.phase.polar import Polar
from fogproof.scene import Schlick


def density(phase: Schlick, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]."""
    a, from_peak = abs(phase.k), versine if phase.k >= 0 else coversine
    return (1 - a) * (1 + a) / (4 * np.pi * ((1 - a) + a * from_peak) ** 2)


def cosines(phase: Schlick, xi: np.ndarray, out: np.ndarray) -> None:
    """Write forward cosines, absolute error below 10 eps."""
    a = abs(phase.k)
    if phase.k < 0:
        xi = 1 - xi
    q = xi * (2 * a)
    q += 1 - a
    np.divide(xi, q, out=out)
    out *= 2 * (1 + a)
    out -= 1
    if phase.k < 0:
        np.negative(out, out=out)


def polar(phase: Schlick, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf."""
    a, rest = abs(phase.k), 1 - xi
    if phase.k < 0:
        xi, rest = rest, xi
    q = (1 - a) + 2 * a * xi
    from_peak, from_antipode = 2 * (1 - a) * rest / q, 2 * (1 + a) * xi / q
    pdf = q * q / (4 * np.pi * (1 - a) * (1 + a))
    return Polar(from_peak, from_antipode, pdf) if phase.k >= 0 else Polar(from_antipode, from_peak, pdf)
