"""Methods for single scattering: the airlight along a ray from a light."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from fogproof.analytic import single_scattering_variance
from fogproof.capabilities import is_uniform
from fogproof.contracts import Estimator, Reference
from fogproof.errors import InvalidValueError
from fogproof.estimators import Airlight, MarchedAirlight
from fogproof.scene import PointLight
from fogproof.scene.lights import Light
from fogproof.study.methods.method import NO_VARIANCE, Method
from fogproof.study.question import Question

ShadowRays = Literal["exact", "ratio"]


def _light(scene: Question) -> Light:
    if scene.light is None:
        raise InvalidValueError("light", "must be given for the airlight", None, "add a light to the scene")
    return scene.light


@dataclass(frozen=True)
class SingleScattering(Method):
    """One scattering event on the ray, placed at random; placing as in `Airlight`, shadow rays too."""

    placing: Literal["equiangular", "free-path", "distance", "uniform"] = "equiangular"
    shadow_rays: ShadowRays = "exact"
    quantity = "airlight"

    @property
    def title(self) -> str:
        """How the event is placed."""
        return f"{self.placing.capitalize()} sampling"

    @property
    def dimensions(self) -> int | None:
        """One uniform, unless shadow rays are tracked."""
        return 1 if self.shadow_rays == "exact" else None

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator."""
        return Airlight(
            scene.built_medium, scene.ray, _light(scene), self.placing, scene.occluders, shadow_rays=self.shadow_rays
        )

    def variance(self, scene: Question) -> Reference | None:
        """Return it for a point light in a homogeneous medium."""
        medium: Any = scene.built_medium
        plain = is_uniform(medium) and isinstance(scene.light, PointLight) and not scene.occluders
        if not plain or self.shadow_rays != "exact":
            return None
        assert isinstance(scene.light, PointLight)
        return single_scattering_variance(medium, scene.ray, scene.light, self.placing)


@dataclass(frozen=True)
class MixedSingleScattering(Method):
    """Equiangular or distance sampling by the toss of a coin, combined by the balance heuristic (MIS)."""

    shadow_rays: ShadowRays = "exact"
    quantity = "airlight"
    title = "Equiangular and distance sampling by MIS"

    @property
    def dimensions(self) -> int | None:
        """One uniform, unless shadow rays are tracked."""
        return 1 if self.shadow_rays == "exact" else None

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator."""
        return Airlight(
            scene.built_medium, scene.ray, _light(scene), "mixed", scene.occluders, shadow_rays=self.shadow_rays
        )


@dataclass(frozen=True)
class MarchedSingleScattering(Method):
    """A Riemann sum along the ray.

    rule   "midpoint" and "right" are not random, and the study's counts are their steps; "jittered" draws one place in each of
           `steps` steps, without bias
    """

    rule: Literal["midpoint", "right", "jittered"] = "midpoint"
    steps: int = 16
    quantity = "airlight"

    def __post_init__(self) -> None:
        if self.rule != "jittered" and self.steps != 16:
            raise InvalidValueError("steps", "must not be given unless rule is 'jittered'", self.steps)
        if self.steps < 1:
            raise InvalidValueError("steps", "must be a whole number >= 1", self.steps)

    @property
    def title(self) -> str:
        """The rule."""
        return {"midpoint": "Marching, midpoints", "right": "Marching, right ends", "jittered": "Jittered marching"}[
            self.rule
        ]

    @property
    def axis(self) -> str:
        """Steps, or samples."""
        return "samples" if self.rule == "jittered" else "steps"

    @property
    def bias(self) -> str:
        """A Riemann sum is biased, a jittered one is not."""
        return "" if self.rule == "jittered" else "a Riemann sum is biased; the bias falls with the step"

    @property
    def dimensions(self) -> int | None:
        """One uniform a step."""
        return self.steps if self.rule == "jittered" else None

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator."""
        steps = self.steps if self.rule == "jittered" else count
        return MarchedAirlight(scene.built_medium, scene.ray, _light(scene), steps, self.rule, scene.occluders)

    def variance(self, scene: Question) -> Reference | None:
        """Return 0 where nothing is random."""
        if self.rule == "jittered":
            return None
        return NO_VARIANCE
