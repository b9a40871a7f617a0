"""Mitsuba's emitters: directions towards them from a point, and the rays that they send out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from fogproof.adapters.mitsuba.runtime import Plugin, built, description, evaluate, loaded
from fogproof.contracts import Draw
from fogproof.domains import UnitSphere


@dataclass(frozen=True, eq=False)
class MitsubaEmitter:
    """The direction towards an emitter, from `point`: `plugin` is an emitter or a shape that is one."""

    plugin: Plugin
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    domain: ClassVar[UnitSphere] = UnitSphere()
    dimensions: ClassVar[int] = 2

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 2) to directions, pdf [1/sr]; a sample without probability is given up."""
        emitter, interaction, _ = self._built

        def ask(others: Any) -> tuple[Any, ...]:
            drawn, _weight = emitter.sample_direction(interaction, others)
            return drawn.d, drawn.pdf

        rows = evaluate(ask, u)
        return Draw(rows[:, :3], rows[:, 3], valid=rows[:, 3] > 0)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of directions x (n, 3) [1/sr]; what does not meet the emitter has none."""
        emitter, interaction, scene = self._built

        def ask(direction: Any) -> tuple[Any, ...]:
            import mitsuba as mi

            hit = scene.ray_intersect(interaction.spawn_ray(direction))
            towards = mi.DirectionSample3f(scene, hit, interaction)
            towards.d = direction
            met = hit.emitter(scene) == emitter
            density = emitter.pdf_direction(interaction, towards)
            return (mi.Float(met) * density if not isinstance(met, bool) else (density if met else 0.0),)

        return evaluate(ask, x)[:, 0]

    @cached_property
    def _built(self) -> tuple[Any, Any, Any]:
        return built(self._build)

    def _build(self, mi: Any) -> tuple[Any, Any, Any]:
        import drjit

        scene = mi.load_dict({"type": "scene", "subject": description(self.plugin)})
        interaction = drjit.zeros(mi.Interaction3f)
        interaction.p = mi.Point3f(*self.point)
        return scene.emitters()[0], interaction, scene


@dataclass(frozen=True, eq=False)
class MitsubaRays:
    """Directions of the rays that an emitter at one point sends out."""

    plugin: Plugin
    domain: ClassVar[UnitSphere] = UnitSphere()
    dimensions: ClassVar[int] = 4

    def sample(self, u: np.ndarray) -> np.ndarray:
        """Map uniforms (n, 4) to directions."""
        emitter = self._built

        def ask(first: Any, second: Any) -> tuple[Any, ...]:
            ray, _ = emitter.sample_ray(0.0, 0.5, first, second)
            return (ray.d,)

        return evaluate(ask, u[:, :2], u[:, 2:])

    @cached_property
    def _built(self) -> Any:
        return built(lambda mi: loaded(mi, self.plugin))
