"""Single scattering by marching: a Riemann sum of the in-scattered light over equal steps of the camera ray."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import InvalidValueError
from fogproof.estimators.airlight.lit_medium import LitMedium
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.lights import Light
from fogproof.scene.occluders import Occluder
from fogproof.scene.shapes import Shape, Unbounded

Rule = Literal["midpoint", "right", "jittered"]


@dataclass(frozen=True, eq=False)
class MarchedAirlight:
    """The sum of T(camera, x_k) sigma_s f_p E(x_k) T(x_k, light) dt over N steps.

    steps  N
    rule   where x_k lies in its step. "midpoint" has a bias of order dt^2, "right" (T_k = T_(k-1) exp(-sigma_t(x_k) dt), as
           often printed) one of order dt; in both the transmittance is marched too, and nothing is random. "jittered" draws
           x_k anew for each step and takes the transmittance in closed form: no bias, at the variance of stratified sampling

    The other arguments are those of `LitMedium`; the ray ends, and the light is not an environment.
    """

    medium: AnyMedium
    ray: Ray
    light: Light
    steps: int
    rule: Rule = "midpoint"
    occluders: tuple[Occluder, ...] = ()
    shape: Shape = field(default_factory=Unbounded)

    def __post_init__(self) -> None:
        if isinstance(self.steps, bool) or not isinstance(self.steps, int) or self.steps < 1:
            raise InvalidValueError("steps", "must be a whole number >= 1", self.steps)
        if self.rule not in get_args(Rule):
            raise InvalidValueError("rule", f"must be one of {', '.join(get_args(Rule))}", self.rule)
        if not np.isfinite(self._lit.length):
            raise InvalidValueError("ray", "must end: nobody marches to infinity", self.ray.length)

    @cached_property
    def _lit(self) -> LitMedium:
        return LitMedium(self.medium, self.ray, self.light, self.occluders, self.shape)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance [W/(m^2 sr)], each at the cost of N places looked at."""
        if self.rule != "jittered":
            return Draws(np.full(n, self._sum(rng)), np.full(n, float(self.steps)))
        value, cost = np.zeros((2, n))
        step = self._lit.length / self.steps
        for k in range(self.steps):
            t = step * (k + rng.random(n))
            scattered, looked = self._lit.scattered(t, rng)
            value += step * self._lit.seen(t) * scattered
            cost += looked
        return Draws(value, cost)

    def _sum(self, rng: np.random.Generator) -> float:
        """Return the sum, and march the transmittance along with it."""
        lit, step = self._lit, self._lit.length / self.steps
        t = step * (np.arange(self.steps) + (0.5 if self.rule == "midpoint" else 1.0))
        gained = lit.extinction.sigma(t) * step
        depth = np.cumsum(gained) - (0.5 * gained if self.rule == "midpoint" else 0.0)
        return float(np.sum(np.exp(-depth) * lit.scattered(t, rng)[0]) * step)
