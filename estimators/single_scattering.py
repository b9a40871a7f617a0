"""Single scattering of a light with a direction: one scattering event on the camera ray, connected to the light."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import UnsupportedError
from fogproof.estimators.blocks import blocks
from fogproof.estimators.lit_medium import LitMedium
from fogproof.estimators.placing import Placer, Placing, placer
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.lights import DirectionalLight, Light, PointLight, SpotLight
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

    def __post_init__(self) -> None:
        if not isinstance(self.light, PointLight | SpotLight | DirectionalLight):
            raise UnsupportedError("Airlight needs a light with a direction; see EnvironmentAirlight", "light")

    @cached_property
    def _lit(self) -> LitMedium:
        return LitMedium(self.medium, self.ray, self.light, self.occluders, self.shape)

    @cached_property
    def _placer(self) -> Placer:
        return placer(self._lit, self.placing)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance [W/(m^2 sr)], each at the cost of one place looked at."""
        value = np.zeros(n)
        for block in blocks(n if self._lit.length > 0 else 0):
            value[block] = self._some(rng, len(value[block]))
        return Draws(value, np.ones(n))

    def _some(self, rng: np.random.Generator, n: int) -> np.ndarray:
        places = self._placer.sample(rng.random((n, 1)))
        assert places.pdf is not None
        if places.event is None:
            return self._lit.seen(places.x) * self._lit.scattered(places.x, rng) / places.pdf
        inside = places.event == 0  # a path that leaves the medium sees no airlight
        t = np.where(inside, places.x, 0.0)
        return np.where(inside, self._lit.seen(t) * self._lit.scattered(t, rng) / places.pdf, 0.0)
