"""Mitsuba's media: free paths along a ray, and the transmittance by which it weighs them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from fogproof.adapters.mitsuba.runtime import Plugin, built, evaluate, loaded
from fogproof.contracts import Draw, Draws
from fogproof.domains import HalfLine
from fogproof.scene import Ray


@dataclass(frozen=True, eq=False)
class MitsubaFreePath:
    """The free path to the next collision, real or null, in a medium with one majorant along a ray; channel 0 is sampled.

    `transmittance_eval_pdf` says the density that Mitsuba claims.
    """

    plugin: Plugin
    ray: Ray
    majorant: float
    domain: ClassVar[HalfLine] = HalfLine(0.0)
    dimensions: ClassVar[int] = 1

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 1) to distances [m] and the density that Mitsuba says at them [1/m]."""
        mi, medium, ray = self._built

        def ask(first: Any) -> tuple[Any, ...]:
            import drjit

            collision = medium.sample_interaction(ray, first, mi.UInt32(0), True)
            surface = drjit.zeros(mi.SurfaceInteraction3f)
            surface.t = mi.Float(float("inf"))
            _, pdf = medium.transmittance_eval_pdf(collision, surface, True)
            return collision.t, pdf[0]

        rows = evaluate(ask, u[:, 0])
        return Draw(rows[:, 0], rows[:, 1])

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return sigma exp(-sigma t) of the majorant [1/m]."""
        return self.majorant * np.exp(-self.majorant * x)

    @cached_property
    def _built(self) -> tuple[Any, Any, Any]:
        return built(lambda mi: (mi, loaded(mi, self.plugin), _ray(mi, self.ray)))


@dataclass(frozen=True, eq=False)
class MitsubaTransmittance:
    """Transmittance along a ray by ratio tracking with Mitsuba's own collisions and extinctions (Novák et al. 2014)."""

    plugin: Plugin
    ray: Ray

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the transmittance of channel 0, at the cost of their look-ups."""
        mi, medium, ray = self._built
        length, at = float(self.ray.length), np.zeros(n)
        value, cost = np.ones(n), np.zeros(n)
        alive = np.arange(n)
        while len(alive):
            start = at[alive]

            def ask(first: Any, behind: Any) -> tuple[Any, ...]:
                moved = mi.Ray3f(ray.o + behind * ray.d, ray.d)
                collision = medium.sample_interaction(moved, first, mi.UInt32(0), True)
                return collision.t, collision.sigma_n[0] / collision.combined_extinction[0]

            rows = evaluate(ask, rng.random(len(alive), dtype=np.float32), start)
            at[alive] = start + rows[:, 0]
            inside = at[alive] < length
            value[alive[inside]] *= rows[inside, 1]
            cost[alive] += inside
            alive = alive[inside]
        return Draws(value, cost)

    @cached_property
    def _built(self) -> tuple[Any, Any, Any]:
        return built(lambda mi: (mi, loaded(mi, self.plugin), _ray(mi, self.ray)))


def _ray(mi: Any, ray: Ray) -> Any:
    return mi.Ray3f(mi.Point3f(*ray.origin.tolist()), mi.Vector3f(*ray.direction.tolist()))
