"""Volumetric path tracing: radiance along one camera ray, scattered any number of times (Kajiya & Von Herzen 1984).

One distance and one direction at a time, so that no path ever splits: the one-sample estimator of the volume rendering
equation, with or without next-event estimation.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, get_args

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators.kernels.path_data import PathRows, PathRules, PathScene
from fogproof.estimators.paths import data as path_data
from fogproof.estimators.phase.functions import kernel_lobe
from fogproof.estimators.tracking.majorant_grid import MajorantGrid
from fogproof.estimators.tracking.tracked import refuse, single
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.lights import Light
from fogproof.scene.shapes import Shape
from fogproof.scene.surfaces import Surface
from fogproof.validate import number

LightSampling = Literal["nee", "bsdf", "mis"]
"""How light is gathered: by looking for it at every collision and reflection (next-event estimation), where paths meet it in the
directions that phase function and surface give them, or by both with the balance heuristic (multiple importance sampling)."""

ENDLESS = 1 << 62


@dataclass(frozen=True)
class Roulette:
    """From scattering order `start` on, paths go on with probability min(throughput, survival), and weigh that much more.

    With survival 1 no path weighs more than the light it could have carried; below, the variance may be infinite where little is
    absorbed.
    """

    start: int = 5
    survival: float = 1.0

    def __post_init__(self) -> None:
        whole("start", self.start, 0)
        if not number("survival", self.survival, "must lie in (0, 1]", 0, 1) > 0:
            raise InvalidValueError("survival", "must lie in (0, 1]", self.survival)


@dataclass(frozen=True, eq=False)
class PathTracer:
    """Radiance along one ray [W/(m^2 sr)]; everything grey.

    medium            fills `shape`; albedo and emission the same everywhere, any phase function (one that varies in space by
                      a `Ramp`). Media with bounds of their own end there as well
    shape             convex, with vacuum outside
    ray               away from the camera, which may be inside; its length is not used
    light             a point or directional light, or an environment; None for none
    surface           opaque, in or behind the medium, not in touch with its boundary if that refracts
    light_sampling    None: "nee" with a point or directional light, "mis" with an environment, "bsdf" if the boundary refracts
    refractive_index  of the medium; other than 1 its boundary reflects and refracts, and light has to be met; what the medium
                      emits is then its radiance over index^2, which is the same on both sides of the boundary
    ambient           in-scattered radiance that a collision takes as constant instead of following it
    deepest           greatest scattering order: 0 none, 1 single; None for all
    columns           how many the result has, one for each order and the last for all beyond; 1 is just the radiance
    roulette          None: paths go on until they leave or carry nothing
    events            collisions and reflections after which a path is cut, and says so
    majorant          bound of sigma_t for tracking [1/m]: a number, in blocks, or None for the medium's own
    """

    medium: AnyMedium
    shape: Shape
    ray: Ray
    light: Light | None = None
    surface: Surface | None = None
    light_sampling: LightSampling | None = None
    refractive_index: float = 1.0
    ambient: float | None = None
    deepest: int | None = None
    columns: int = 1
    roulette: Roulette | None = field(default_factory=Roulette)
    events: int = 1_000_000
    majorant: float | MajorantGrid | None = None

    def __post_init__(self) -> None:
        single(self.ray)
        number("refractive_index", self.refractive_index, "must be finite and > 0", 0, open_ends=True)
        whole("columns", self.columns, 1)
        whole("events", self.events, 1)
        if self.deepest is not None:
            whole("deepest", self.deepest, 0)
        if self.ambient is not None:
            number("ambient", self.ambient, "must be finite and >= 0 [W/(m^2 sr)]", 0)
        choose_light_sampling(self.light_sampling, self.light, self.surface, self.refractive_index)

    @cached_property
    def _scene(self) -> PathScene:
        """Everything but the ray, for the kernel."""
        how = choose_light_sampling(self.light_sampling, self.light, self.surface, self.refractive_index)
        albedo, emission = path_data.sources(self.medium)
        roulette = self.roulette or Roulette(ENDLESS, 1.0)
        rules = PathRules(
            albedo,
            emission,
            self.refractive_index,
            how != "bsdf",
            how != "nee",
            ENDLESS if self.deepest is None else self.deepest,
            -1.0 if self.ambient is None else self.ambient,
            roulette.start,
            roulette.survival,
            self.events,
        )
        medium, bound = path_data.medium_and_bound(self.medium, self.shape, self.majorant)
        lobe, lamp, wall = kernel_lobe(self.medium.phase), path_data.lamp(self.light), path_data.wall(self.surface)
        return PathScene(medium, bound, path_data.region(self.shape), lobe, lamp, wall, rules)

    def paths(self, rng: np.random.Generator, n: int) -> PathRows:
        """Follow n paths."""
        return trace(self._scene, self.ray.origin[None], self.ray.direction[None], rng, n, self.columns)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance: (n,), or (n, columns) if there are several columns."""
        paths = self.paths(rng, n)
        return Draws(paths.value[:, 0] if self.columns == 1 else paths.value, paths.cost, paths.scatterings)


def trace(
    scene: PathScene, origin: np.ndarray, direction: np.ndarray, rng: np.random.Generator, n: int, columns: int
) -> PathRows:
    """Follow n paths from rays (1, 3) or (n, 3) through a scene made ready for the kernel."""
    from fogproof.estimators.kernels import paths as kernel_paths

    return run(kernel_paths.trace, (scene,), origin, direction, rng, n, columns)


def run(
    kernel: Any,
    scene: tuple[Any, ...],
    origin: np.ndarray,
    direction: np.ndarray,
    rng: np.random.Generator,
    n: int,
    columns: int,
) -> PathRows:
    """Run a path tracing kernel, and raise if it met an extinction that its bound does not allow."""
    from fogproof.estimators.kernels.compiling import uncached

    rows = PathRows(np.empty((n, columns)), np.empty(n), np.empty(n, np.int64), np.empty(n))
    if getattr(scene[0].medium, "of_user", False):
        kernel = uncached(kernel)
    refuse(*kernel(rng, *scene, np.array(origin), np.array(direction), rows))
    return rows


def choose_light_sampling(
    light_sampling: Any, light: Light | None, surface: Surface | None, refractive_index: float
) -> LightSampling:
    """Return how light is gathered, or say why it cannot be as asked."""
    if light_sampling not in (None, *get_args(LightSampling)):
        rule = f"must be one of {', '.join(get_args(LightSampling))}"
        raise InvalidValueError("light_sampling", rule, light_sampling)
    refracts = refractive_index != 1
    if light is not None and light.delta:
        if light_sampling not in (None, "nee"):
            raise InvalidValueError("light_sampling", "must be 'nee': paths never meet such a light", light_sampling)
        if refracts or (surface is not None and surface.finish == "mirror" and surface.albedo > 0):
            what = "light behind a mirror or a refracting boundary cannot be looked for"
            raise UnsupportedError(f"{what}; use an Environment", "light")
        return "nee"
    if refracts and light_sampling not in (None, "bsdf"):
        raise InvalidValueError("light_sampling", "must be 'bsdf' behind a refracting boundary", light_sampling)
    return light_sampling or ("mis" if light is not None and not refracts else "bsdf")


def whole(name: str, value: Any, least: int) -> None:
    """Raise unless a value is a whole number and large enough."""
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise InvalidValueError(name, f"must be a whole number >= {least}", value)
