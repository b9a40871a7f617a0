"""Airlight of a point light in a homogeneous medium: one scattering event, placed by two different samplers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import UnsupportedError
from fogproof.estimators.equiangular import Equiangular
from fogproof.estimators.free_path import FreePath
from fogproof.estimators.grey import grey
from fogproof.estimators.phase import phase_value
from fogproof.scene import Medium, PointLight, Ray


@dataclass(frozen=True)
class _Setting:
    """A ray beside a light, in the coordinate t along the ray from the foot of the perpendicular."""

    sigma_t: float
    strength: float  # sigma_s times the light's intensity [W/(m sr)]
    h: float
    a: float
    b: float

    def radiance_density(self, medium: Medium, t: np.ndarray) -> np.ndarray:
        """Return the airlight scattered at t, per unit length [W/(m^3 sr)]."""
        r2 = self.h * self.h + t * t
        r = np.sqrt(r2)
        attenuation = np.exp(-self.sigma_t * ((t - self.a) + r))
        return self.strength * phase_value(medium.phase, -t / r) * attenuation / r2


def _setting(medium: Medium, ray: Ray, light: PointLight) -> _Setting:
    if ray.shape:
        raise UnsupportedError(f"an estimator looks along one ray, got a batch of shape {ray.shape}", "ray")
    sigma_a, sigma_s = grey("sigma_a", medium.sigma_a), grey("sigma_s", medium.sigma_s)
    to_light = np.asarray(light.position) - ray.origin
    along = float(to_light @ ray.direction)
    h = float(np.linalg.norm(to_light - along * ray.direction))
    strength = sigma_s * grey("intensity", light.intensity)
    return _Setting(sigma_a + sigma_s, strength, h, -along, float(ray.length) - along)


@dataclass(frozen=True, eq=False)
class EquiangularAirlight:
    """The scattering event is placed by equiangular sampling: no 1/r^2 is left in the estimate."""

    medium: Medium
    ray: Ray
    light: PointLight

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the airlight [W/(m^2 sr)]."""
        setting = _setting(self.medium, self.ray, self.light)
        sampler = Equiangular(setting.h, setting.a, setting.b)
        positions = sampler.sample(rng.random((n, 1)))
        return Draws(setting.radiance_density(self.medium, positions.x) / positions.pdf, cost=np.ones(n))


@dataclass(frozen=True, eq=False)
class FreePathAirlight:
    """The scattering event is placed by the free path: paths that reach the surface see no airlight.

    Near the light the 1/r^2 that is left makes the variance large (of order h^-3).
    """

    medium: Medium
    ray: Ray
    light: PointLight

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the airlight [W/(m^2 sr)]."""
        setting = _setting(self.medium, self.ray, self.light)
        paths = FreePath(setting.sigma_t, float(self.ray.length)).sample(rng.random((n, 1)))
        value = setting.radiance_density(self.medium, paths.x + setting.a) / paths.pdf
        return Draws(np.where(paths.event == 1, 0.0, value), cost=np.ones(n))
