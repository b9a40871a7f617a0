"""Von Mises-Fisher directions: the distribution of mu is inverted (Jakob 2012, Numerically stable sampling of the vMF).

With a = |kappa| the angle from the peak has 1 - mu = -log(xi + (1 - xi) exp(-2 a))/a; where that would cancel, log1p takes
the place of log, and 1 + mu = log(1 + xi (exp(2 a) - 1))/a has digits of its own.
"""

from __future__ import annotations

import math

import numpy as np

from fogproof.estimators.phase.polar import Polar
from fogproof.scene.phase import VonMisesFisher

FLAT = 1e-17
"""|kappa| below which the density is constant to the last digit."""

OVERFLOWS = 40.0
"""|kappa| beyond which 1 + mu comes from 1 - mu: with it smaller than that only below a probability of exp(-40)."""


def density(phase: VonMisesFisher, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]."""
    a = abs(phase.kappa)
    if a < FLAT:
        return np.full_like(versine, 0.25 / np.pi)
    from_peak = versine if phase.kappa > 0 else coversine
    with np.errstate(under="ignore"):
        value: np.ndarray = np.exp(-a * from_peak) * (a / (2 * np.pi * -math.expm1(-2 * a)))
    return value


def polar(phase: VonMisesFisher, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf."""
    a, rest = abs(phase.kappa), 1 - xi
    if a < FLAT:
        return Polar(2 * rest, 2 * xi, np.full_like(xi, 0.25 / np.pi))
    near, far = (xi, rest) if phase.kappa > 0 else (rest, xi)
    lost = -math.expm1(-2 * a)
    with np.errstate(under="ignore", divide="ignore"):
        from_peak = np.where(far * lost < 0.5, -np.log1p(-far * lost), -np.log(near + far * math.exp(-2 * a))) / a
        from_peak = np.minimum(from_peak, 2).astype(xi.dtype)
        known = a < OVERFLOWS
        from_antipode = (np.log1p(near * math.expm1(2 * a)) / a).astype(xi.dtype) if known else 2 - from_peak
    versine, coversine = (from_peak, from_antipode) if phase.kappa > 0 else (from_antipode, from_peak)
    return Polar(versine, coversine, density(phase, versine, coversine))
