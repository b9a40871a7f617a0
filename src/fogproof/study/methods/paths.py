"""Path tracing: the radiance along a ray through a medium that scatters any number of times."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.contracts import Estimator
from fogproof.estimators import PathTracer
from fogproof.estimators.paths.tracer import LightSampling
from fogproof.study.methods.method import Method
from fogproof.study.question import Question

_TITLES = {
    "bsdf": "Path tracing without next-event estimation",
    "nee": "Path tracing with next-event estimation",
    "mis": "Path tracing with MIS of both",
}


@dataclass(frozen=True)
class PathTracing(Method):
    """Volumetric path tracing; `light_sampling` says whether light is looked for at every collision (next-event estimation)."""

    light_sampling: LightSampling = "mis"
    quantity = "radiance"

    @property
    def title(self) -> str:
        """How light is gathered."""
        return _TITLES[self.light_sampling]

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator."""
        return PathTracer(scene.built_medium, scene.shape, scene.ray, scene.light, light_sampling=self.light_sampling)
