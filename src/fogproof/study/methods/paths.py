"""Path tracing: the radiance along a ray through a medium that scatters any number of times."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from fogproof.analytic import ball_radiance
from fogproof.analytic.media.coefficients import is_uniform
from fogproof.contracts import Estimator, Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators import PathTracer
from fogproof.estimators.paths.tracer import LightSampling
from fogproof.scene import Isotropic
from fogproof.scene.lights import Environment
from fogproof.scene.shapes import Ball

if TYPE_CHECKING:
    from fogproof.study.files import StudyScene

_TITLES = {
    "bsdf": "Path tracing without next-event estimation",
    "nee": "Path tracing with next-event estimation",
    "mis": "Path tracing with MIS of both",
}


def radiance_of_ball(scene: StudyScene) -> Reference:
    """Return the radiance [W/(m^2 sr)] along a ray that crosses a ball under a uniform sky, all orders of scattering."""
    medium, light, shape, ray = scene.matter, scene.light, scene.shape, scene.ray
    if not isinstance(shape, Ball) or not isinstance(light, Environment):
        what = "the radiance of all orders is known of a ball in an environment"
        raise InvalidValueError("shape", f"must be a ball, and the light an environment: {what}", shape)
    if not is_uniform(medium) or not isinstance(medium.phase, Isotropic) or np.any(medium.emission):
        raise UnsupportedError("the ball must be homogeneous, scatter isotropically and emit nothing", "medium")
    out = ray.origin - np.asarray(shape.center)
    along = float(out @ ray.direction)
    impact = float(np.linalg.norm(out - along * ray.direction))
    if not (np.linalg.norm(out) > shape.radius and along < 0 and impact < shape.radius):
        raise InvalidValueError("ray", "must start outside the ball and cross it", ray.origin.tolist())
    sigma_t, strength = float(np.asarray(medium.sigma_t)), float(np.asarray(light.radiance))
    reference = ball_radiance(medium.albedo, sigma_t * shape.radius, sigma_t * impact)
    return Reference(strength * reference.value, strength * reference.error, reference.method, reference.source)


@dataclass(frozen=True)
class PathTracing:
    """Volumetric path tracing; `light_sampling` says whether light is looked for at every collision (next-event estimation)."""

    light_sampling: LightSampling = "mis"
    quantity: ClassVar[str] = "radiance"
    axis: ClassVar[str] = "samples"
    expected: ClassVar[str] = "not rejected"
    reason: ClassVar[str] = ""
    dimensions: ClassVar[None] = None

    @property
    def title(self) -> str:
        """How light is gathered."""
        return _TITLES[self.light_sampling]

    def make(self, scene: StudyScene, count: int) -> Estimator:
        """Return the estimator."""
        return PathTracer(scene.matter, scene.shape, scene.ray, scene.light, light_sampling=self.light_sampling)

    def variance(self, scene: StudyScene) -> Reference | None:
        """Return None: nobody knows it."""
        return None
