"""Hazy and murky atmospheres (after Nishita, Miyawaki & Nakamae 1987): (1/2 + (n + 1)/2 u^n)/(4 pi), u = (1 + mu)/2.

Half of the light is isotropic, u uniform; the other half has u = xi^(1/(n + 1)). One uniform serves both the choice and the
value: |2 xi - 1| is exact and uniform in either half.
"""

from __future__ import annotations

import numpy as np

from fogproof.estimators.polar import Polar
from fogproof.scene import Hazy, Murky

POWER: dict[type, int] = {Hazy: 8, Murky: 32}
"""The exponent n of u."""


def density(phase: Hazy | Murky, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]."""
    return _density(POWER[type(phase)], coversine)


def _density(n: int, coversine: np.ndarray) -> np.ndarray:
    power = 0.5 * coversine
    for _ in range(n.bit_length() - 1):  # n is a power of two
        power *= power
    power *= (n + 1) / (8 * np.pi)
    power += 1 / (8 * np.pi)
    return power


def cosines(phase: Hazy | Murky, xi: np.ndarray) -> np.ndarray:
    """Return forward cosines."""
    u, lobe = _split(xi)
    np.exp(_log(u) / (POWER[type(phase)] + 1), out=u, where=lobe)
    u *= 2
    u -= 1
    return u


def polar(phase: Hazy | Murky, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf."""
    n = POWER[type(phase)]
    u, lobe = _split(xi)
    log = _log(u) / (n + 1)
    coversine = 2 * np.where(lobe, np.exp(log), u)
    versine = np.where(lobe, -2 * np.expm1(log), 2 * (1 - u))
    return Polar(versine, coversine, _density(n, coversine))


def _split(xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a fresh uniform in [0, 1] and whether it is for the lobe."""
    u = 2 * xi
    u -= 1
    lobe = u >= 0
    return np.abs(u, out=u), lobe


def _log(u: np.ndarray) -> np.ndarray:
    """Return log u, and for u = 0 that of the smallest normal number: its root is as good as 0 in a cosine."""
    return np.log(np.maximum(u, np.finfo(u.dtype).tiny))
