"""Single scattering of a light with a direction: one scattering event on the camera ray, connected to the light."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import UnsupportedError
from fogproof.estimators.airlight.lighting import can_be_sampled
from fogproof.estimators.airlight.lit_medium import LitMedium
from fogproof.estimators.airlight.placing import Placer, Placing, placer
from fogproof.estimators.airlight.shadow_rays import ShadowRays
from fogproof.estimators.blocks import blocks
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.lights import Light
from fogproof.scene.occluders import Occluder
from fogproof.scene.shapes import Shape, Unbounded


@dataclass(frozen=True, eq=False)
class Airlight:
    """T(camera, x) sigma_s f_p E(x) T(x, light) / p(t) at one place t of the ray; E is the irradiance, 0 in the shadow.

    placing  how t is drawn. "equiangular" leaves no 1/r^2 in the estimate; with "free-path" and "distance" the variance near a
             light is of order h^-3; "mixed" is bounded by the better of the two

    The other arguments are those of `LitMedium`; the light is not an environment.
    """

    medium: AnyMedium
    ray: Ray
    light: Light
    placing: Placing = "equiangular"
    occluders: tuple[Occluder, ...] = ()
    shape: Shape = field(default_factory=Unbounded)
    shadow_rays: ShadowRays = "exact"

    def __post_init__(self) -> None:
        if not can_be_sampled(self.light):
            raise UnsupportedError(
                "Airlight needs a light that points know where to look for; see EnvironmentAirlight", "light"
            )

    @cached_property
    def _lit(self) -> LitMedium:
        return LitMedium(self.medium, self.ray, self.light, self.occluders, self.shape, self.shadow_rays)

    @cached_property
    def _placer(self) -> Placer:
        return placer(self._lit, self.placing)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance [W/(m^2 sr)], at the cost of their look-ups."""
        if self._lit.length == 0:
            return Draws(np.zeros(n), np.zeros(n))
        return one_sample(self._lit, self._placer, self._lit.seen, rng, n)


def one_sample(
    lit: LitMedium, places: Placer, seen: Callable[[np.ndarray], np.ndarray], rng: np.random.Generator, n: int
) -> Draws:
    """Return n one-sample estimates with places drawn by `places` and a given transmittance from the camera."""
    value, cost = np.empty((2, n))
    for block in blocks(n):
        drawn = places.sample(rng.random((len(value[block]), 1)))
        assert drawn.pdf is not None
        out = None if drawn.event is None else drawn.event != 0
        t = drawn.x if out is None else np.where(out, 0.0, drawn.x)
        scattered, cost[block] = lit.scattered(t, rng)
        scattered *= seen(t)
        np.divide(scattered, drawn.pdf, out=value[block])
        if out is not None:
            value[block][out] = 0.0  # a path that leaves the medium sees none
    return Draws(value, cost)
