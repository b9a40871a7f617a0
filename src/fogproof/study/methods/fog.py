"""Methods for ambient fog: the radiance along a ray in constant in-scattered light."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from fogproof.analytic import ambient_fog_variance
from fogproof.contracts import Estimator, Reference
from fogproof.estimators import AnalogFog, CertainCollisionFog

if TYPE_CHECKING:
    from fogproof.study.files import StudyScene


@dataclass(frozen=True)
class AnalogFogMethod:
    """One free path: the source where it collides, the background where it does not."""

    quantity: ClassVar[str] = "fog"
    title: ClassVar[str] = "Fog by free paths"
    axis: ClassVar[str] = "samples"
    expected: ClassVar[str] = "not rejected"
    reason: ClassVar[str] = ""
    dimensions: ClassVar[int] = 1

    def make(self, scene: StudyScene, count: int) -> Estimator:
        """Return the estimator."""
        return AnalogFog(scene.matter, scene.ray, scene.ambient, scene.background)

    def variance(self, scene: StudyScene) -> Reference | None:
        """Return that of two values."""
        return ambient_fog_variance(scene.matter, scene.ray, scene.ambient, scene.background)


@dataclass(frozen=True)
class CertainCollision:
    """The background in closed form, and one collision that is sure to happen: without variance where the source is constant."""

    quantity: ClassVar[str] = "fog"
    title: ClassVar[str] = "Fog with a certain collision"
    axis: ClassVar[str] = "nothing"
    expected: ClassVar[str] = "not rejected"
    reason: ClassVar[str] = ""
    dimensions: ClassVar[None] = None

    def make(self, scene: StudyScene, count: int) -> Estimator:
        """Return the estimator."""
        return CertainCollisionFog(scene.matter, scene.ray, scene.ambient, scene.background)

    def variance(self, scene: StudyScene) -> Reference | None:
        """Return 0: albedo and emission are the same everywhere."""
        return Reference(np.asarray(0.0), np.asarray(0.0), "a constant source", "")
