"""Volumetric path tracing of many colours at once: one path serves all channels (Wilkie et al. 2014)."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import UnsupportedError
from fogproof.estimators.kernels.path_data import Colours, PathRows, PathRules, PathScene
from fogproof.estimators.paths import data as path_data
from fogproof.estimators.paths.tracer import ENDLESS, LightSampling, Roulette, choose_light_sampling, run
from fogproof.estimators.phase.functions import kernel_lobe
from fogproof.estimators.tracking.majorant_grid import MajorantGrid
from fogproof.estimators.tracking.tracked import single
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.lights import Light, strength, with_strength
from fogproof.scene.shapes import Shape
from fogproof.scene.surfaces import Surface
from fogproof.validate import channel_count


@dataclass(frozen=True, eq=False)
class SpectralPathTracer:
    """Radiance along one ray in every channel [W/(m^2 sr)]; arguments as in `PathTracer`, without refraction.

    Medium and light may have channels; the weight of a path never exceeds their number.
    """

    medium: AnyMedium
    shape: Shape
    ray: Ray
    light: Light | None = None
    surface: Surface | None = None
    light_sampling: LightSampling | None = None
    deepest: int | None = None
    roulette: Roulette | None = field(default_factory=Roulette)
    events: int = 1_000_000
    majorant: float | MajorantGrid | None = None

    def __post_init__(self) -> None:
        single(self.ray)
        choose_light_sampling(self.light_sampling, self.light, self.surface, 1.0)
        if self.channels == 0:
            raise UnsupportedError("neither medium nor light have channels; use PathTracer", "medium")

    @property
    def channels(self) -> int:
        """How many channels medium and light have together; 0 if both are grey."""
        medium = (0.0,) * self.medium.channels if self.medium.channels else 0.0
        return channel_count(medium=medium, light=0.0 if self.light is None else strength(self.light)) or 0

    @cached_property
    def _scene(self) -> tuple[PathScene, Colours]:
        """Everything but the ray, for the kernel."""
        how = choose_light_sampling(self.light_sampling, self.light, self.surface, 1.0)
        roulette, deepest = self.roulette or Roulette(ENDLESS, 1.0), ENDLESS if self.deepest is None else self.deepest
        look, meet = how != "bsdf", how != "nee"
        rules = PathRules(1.0, 0.0, 1.0, look, meet, deepest, -1.0, roulette.start, roulette.survival, self.events)
        lobe, wall = kernel_lobe(self.medium.phase), path_data.wall(self.surface)
        albedo, emission = (self._constant(name) for name in ("albedo", "emission"))
        colour = np.array(np.broadcast_to(0.0 if self.light is None else strength(self.light), self.channels))
        lamp = path_data.lamp(None if self.light is None else with_strength(self.light, 1.0))
        medium, bound = path_data.medium_and_bound(self.medium, self.shape, self.majorant, self.channels)
        region = path_data.region(self.shape)
        return PathScene(medium, bound, region, lobe, lamp, wall, rules), Colours(albedo, emission, colour)

    def _constant(self, name: str) -> np.ndarray:
        if path_data.looks_up(self.medium):
            return np.zeros(self.channels)
        value = getattr(self.medium, name)
        if callable(value) or np.ndim(value) > 1:
            raise UnsupportedError(f"the {name} must be the same everywhere", "medium")
        return np.array(np.broadcast_to(np.asarray(value, dtype=float), self.channels))

    def paths(self, rng: np.random.Generator, n: int) -> PathRows:
        """Follow n paths; the columns of their values are the channels."""
        from fogproof.estimators.kernels.spectral_paths import trace_in_colour

        origin, direction = self.ray.origin[None], self.ray.direction[None]
        return run(trace_in_colour, self._scene, origin, direction, rng, n, self.channels)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance (n, channels)."""
        paths = self.paths(rng, n)
        return Draws(paths.value, paths.cost, paths.scatterings)
