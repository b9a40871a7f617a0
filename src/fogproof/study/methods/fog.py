"""Methods for ambient fog: the radiance along a ray in constant in-scattered light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.analytic import ambient_fog_variance
from fogproof.contracts import Estimator, Reference
from fogproof.estimators import AnalogFog, CertainCollisionFog
from fogproof.estimators.free_paths.fog import source_per_collision
from fogproof.study.methods.method import Method
from fogproof.study.question import Question


@dataclass(frozen=True)
class AnalogFogMethod(Method):
    """One free path: the source where it collides, the background where it does not."""

    quantity = "fog"
    title = "Fog by free paths"
    dimensions = 1

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator."""
        return AnalogFog(scene.built_medium, scene.ray, scene.ambient, scene.background)

    def variance(self, scene: Question) -> Reference | None:
        """Return that of two values."""
        return ambient_fog_variance(scene.built_medium, scene.ray, scene.ambient, scene.background)

    def bounds(self, scene: Question) -> tuple[float, float] | None:
        """Return the source and the background, one of which each path sees; None where they are the same."""
        source = source_per_collision(scene.built_medium, scene.ambient)
        low, high = sorted((source, float(scene.background)))
        return (low, high) if low < high else None


@dataclass(frozen=True)
class CertainCollision(Method):
    """The background in closed form, and one collision that is sure to happen: without variance where the source is constant."""

    quantity = "fog"
    title = "Fog with a certain collision"
    axis = "nothing"

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator."""
        return CertainCollisionFog(scene.built_medium, scene.ray, scene.ambient, scene.background)

    def variance(self, scene: Question) -> Reference | None:
        """Return 0: albedo and emission are the same everywhere."""
        return Reference(np.asarray(0.0), np.asarray(0.0), "a constant source", "")
