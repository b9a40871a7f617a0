"""Murky atmosphere: half isotropic, half a lobe ((1 + mu)/2)^32; see `power_lobe`."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.phase import power_lobe
from fogproof.estimators.phase.polar import Polar
from fogproof.scene import Murky

POWER = 32


def density(_phase: Murky, _versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]."""
    return power_lobe.density(POWER, coversine)


def cosines(_phase: Murky, xi: np.ndarray, out: np.ndarray) -> None:
    """Write forward cosines."""
    power_lobe.cosines(POWER, xi, out)


def polar(_phase: Murky, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf."""
    return power_lobe.polar(POWER, xi)
