"""Analog walks of photons through a slab: no formula of the oracle, and none of the estimators."""

from __future__ import annotations

import numpy as np


def walked(rng, c, tau, mu0, g, photons=40_000):
    """Return the shares reflected, transmitted and absorbed of a beam, and their standard errors."""
    depth, mu = np.zeros(photons), np.full(photons, mu0)
    gone = np.zeros(3)
    while len(depth):
        depth = depth + mu * rng.exponential(size=len(depth))
        up, down = depth < 0, depth > tau
        inside = ~(up | down)
        lost = inside & (rng.random(len(depth)) >= c)
        gone += up.sum(), down.sum(), lost.sum()
        stay = inside & ~lost
        depth, mu = depth[stay], mu[stay]
        s = (1 - g * g) / (1 - g + 2 * g * rng.random(len(mu)))
        turn = np.clip((1 + g * g - s * s) / (2 * g), -1, 1)
        mu = mu * turn + np.sqrt((1 - mu * mu) * (1 - turn * turn)) * np.cos(2 * np.pi * rng.random(len(mu)))
        mu = np.clip(mu, -1, 1)
    share = gone / photons
    return share, np.sqrt((share * (1 - share) + 1 / photons) / photons)
