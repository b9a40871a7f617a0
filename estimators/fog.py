"""Ambient fog by analog free paths: the lerp of the lecture, one collision or the background at a time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.contracts import Draws
from fogproof.estimators.free_path import HomogeneousFreePath
from fogproof.estimators.grey import grey
from fogproof.scene import Medium


@dataclass(frozen=True)
class AnalogFog:
    """Radiance through `length` [m] of a medium in constant in-scattered light.

    medium      homogeneous and grey
    length      distance of the background [m], inf if there is none
    ambient     L_i [W/(m^2 sr)]
    background  [W/(m^2 sr)]

    A path that collides sees (sigma_s L_i + sigma_a L_e) / sigma_t: T / p(t) is 1 / sigma_t there. One that reaches the surface
    sees the background: T / P(z) is 1.
    """

    medium: Medium
    length: float
    ambient: float
    background: float

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance, each at the cost of one sampled path."""
        sigma_a, sigma_s = grey("sigma_a", self.medium.sigma_a), grey("sigma_s", self.medium.sigma_s)
        source = sigma_s * self.ambient + sigma_a * grey("emission", self.medium.emission)
        sigma_t = sigma_a + sigma_s
        paths = HomogeneousFreePath(sigma_t, self.length).sample(rng.random((n, 1)))
        at_collision = source / sigma_t if sigma_t > 0 else 0.0
        return Draws(np.where(paths.event == 1, self.background, at_collision), cost=np.ones(n))
