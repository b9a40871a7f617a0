"""A Legendre series, drawn from as the sum of cosines that it is."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fogproof.estimators.phase.cosine_series import CosineSeries
from fogproof.estimators.phase.polar import Polar
from fogproof.scene.phase import LegendreSeries


@lru_cache(maxsize=16)
def series(phase: LegendreSeries) -> CosineSeries:
    """Return the sum of cosines."""
    m = len(phase.moments) + 1
    beta = (2 * np.arange(m - 1) + 1) * np.array(phase.moments) / (4 * np.pi)
    return CosineSeries(np.polynomial.legendre.legval(np.cos(np.pi * (np.arange(m) + 0.5) / m), beta))


def density(phase: LegendreSeries, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]."""
    return series(phase).density(versine, coversine)


def polar(phase: LegendreSeries, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf."""
    return series(phase).polar(xi)
