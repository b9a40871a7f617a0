"""What a scene of a study asks, and what the oracle answers; it does not know the methods that estimate it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from fogproof.analytic import ambient_fog, ball_radiance, single_scattering, transmittance
from fogproof.analytic.media.coefficients import is_uniform
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import AnyMedium, Isotropic, Ray
from fogproof.scene.lights import Environment, LightField
from fogproof.scene.occluders import OccluderField
from fogproof.scene.shapes import Ball, ShapeField, Unbounded
from fogproof.study.media import StudyMedium, built
from fogproof.validate import number

Estimated = Literal["transmittance", "fog", "airlight", "radiance"]
UNITS = {"transmittance": "1", "fog": "W/(m^2 sr)", "airlight": "W/(m^2 sr)", "radiance": "W/(m^2 sr)"}
_LOOKED_AT: dict[str, tuple[str, ...]] = {
    "transmittance": (),
    "fog": ("ambient", "background"),
    "airlight": ("light", "occluders"),
    "radiance": ("light", "shape"),
}
"""Of what a scene may have beside a medium and a ray."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Question:
    """A quantity along one ray through one medium.

    quantity    "transmittance" along the ray; "fog", the radiance in constant in-scattered light; "airlight", the radiance
                scattered once from the light; "radiance", scattered any number of times in a ball under a sky
    """

    name: str
    quantity: Estimated
    medium: StudyMedium
    ray: Ray
    light: LightField | None = None
    occluders: tuple[OccluderField, ...] = ()
    shape: ShapeField = field(default_factory=Unbounded)
    ambient: float = 0.0
    background: float = 0.0

    def __post_init__(self) -> None:
        number("ambient", self.ambient, "must be finite and >= 0 [W/(m^2 sr)]", 0)
        number("background", self.background, "must be finite and >= 0 [W/(m^2 sr)]", 0)
        if self.quantity not in get_args(Estimated):
            raise InvalidValueError("quantity", f"must be one of {', '.join(get_args(Estimated))}", self.quantity)
        unused = (name for name in self._given() if name not in _LOOKED_AT[self.quantity])
        for name in unused:
            fix = "take it out, or ask for another quantity"
            raise InvalidValueError(
                name, f"must not be given: the {self.quantity} does not look at it", getattr(self, name), fix
            )
        if self.ray.shape:
            raise InvalidValueError("ray", "must be one ray", list(self.ray.shape))

    def _given(self) -> list[str]:
        """Return what the scene has beside a medium and a ray."""
        given = {
            "light": self.light is not None,
            "occluders": bool(self.occluders),
            "shape": not isinstance(self.shape, Unbounded),
            "ambient": self.ambient != 0,
            "background": self.background != 0,
        }
        return [name for name, is_given in given.items() if is_given]

    @cached_property
    def built_medium(self) -> AnyMedium:
        """The medium, read or drawn if it has to be; it is grey."""
        medium = built(self.medium)
        if medium.channels is not None:
            what = f"the medium of scene {self.name!r} has {medium.channels} channels"
            raise UnsupportedError(f"a study follows one channel, {what}: give numbers, not lists", "medium")
        return medium

    def reference(self) -> Reference:
        """Return what the oracle says."""
        match self.quantity:
            case "transmittance":
                return transmittance(self.built_medium, self.ray)
            case "fog":
                return ambient_fog(self.built_medium, self.ray, self.ambient, self.background)
            case "radiance":
                return _radiance_of_ball(self)
        if self.light is None:
            raise InvalidValueError("light", "must be given for the airlight", None, "add a light to the scene")
        return single_scattering(self.built_medium, self.ray, self.light, occluders=self.occluders)


def _radiance_of_ball(scene: Question) -> Reference:
    """Return the radiance [W/(m^2 sr)] along a ray that crosses a ball under a uniform sky, all orders of scattering."""
    medium, light, shape, ray = scene.built_medium, scene.light, scene.shape, scene.ray
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
