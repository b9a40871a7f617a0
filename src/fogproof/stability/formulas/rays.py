"""Rays, and truths of what passes along them, that several themes share."""

from __future__ import annotations

from fogproof.scene import Ray
from fogproof.stability.axes import decades
from fogproof.stability.exact import flint

THICK = decades(1e-300, 1e3, 0.0)


def ray(length):
    return Ray((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), length)


def passed(tau):
    return (-tau).exp() if tau.is_finite() else flint().arb(0)
