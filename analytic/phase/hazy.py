"""Hazy atmosphere: half isotropic, half a lobe ((1 + mu)/2)^8; see `power_lobe`."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase
from fogproof.analytic.phase import power_lobe
from fogproof.analytic.phase.power_lobe import METHOD, SOURCE
from fogproof.scene.phase import Hazy

__all__ = ["METHOD", "SOURCE", "airlight", "ball", "cdf", "legendre_moments", "mean_cosine", "pdf", "peak"]

POWER = 8


def pdf(_phase: Hazy, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]."""
    return power_lobe.pdf(POWER, mu)


def cdf(_phase: Hazy, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu)."""
    return power_lobe.cdf(POWER, mu)


def mean_cosine(_phase: Hazy) -> tuple[float, float]:
    """Return g."""
    return power_lobe.mean_cosine(POWER)


def legendre_moments(_phase: Hazy, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return chi_0 … chi_count."""
    return power_lobe.legendre_moments(POWER, count)


def airlight(_phase: Hazy) -> AirlightPhase:
    """Return 4 pi f."""
    return power_lobe.airlight(POWER)


def ball(_phase: Hazy, mu: Any, _analytic: bool) -> Any:
    """Return 4 pi f."""
    return power_lobe.ball(POWER, mu)


def peak(_phase: Hazy, _mu: Any) -> int:
    """Return the greatest 4 pi f."""
    return 1 + POWER // 2
