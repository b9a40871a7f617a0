"""Single-scattering estimators against the oracle's airlight."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import (
    single_scattering,
    single_scattering_variance,
)
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.contracts import Draws
from fogproof.estimators import (
    Airlight,
    DecoupledAirlight,
    EnvironmentAirlight,
    LitMedium,
    MarchedAirlight,
    placer,
    shadow_transmittance,
)
from fogproof.scene import (
    AnyMedium,
    DoubleHenyeyGreenstein,
    ExponentialMedium,
    HenyeyGreenstein,
    Isotropic,
    LinearMedium,
    Medium,
    Murky,
    PhaseFunction,
    PointLight,
    Ray,
    Rayleigh,
    VoxelGrid,
)
from fogproof.scene.lights import DirectionalLight, Environment, Light, SpotLight
from fogproof.scene.occluders import Disk, Sphere
from fogproof.scene.shapes import Ball, Box, HalfSpace, Slab

RAY = Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0), 5.0)
ENDLESS = Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0))
POINT = PointLight((0.6, -0.8, 0.5), 3.0)
CLOSE = PointLight((0.0, 0.01, 0.5), 3.0)
AXIS = (-6 / 11, 9 / 11, 2 / 11)
SPOT = SpotLight((0.6, -0.8, 0.5), AXIS, 3.0, 0.6, 0.3, 2)
HARD_SPOT = SpotLight((0.6, -0.8, 0.5), AXIS, 3.0, 0.5)
SUN = DirectionalLight((0.6, 0.0, 0.8), 2.0)
BALL, BOX = Ball((0.2, 0.1, 0.0), 2.2), Box((-0.7, -0.9, -1.0), (0.7, 0.5, 1.0))
SLAB, GROUND = Slab((0.0, 0.0, -1.5), (0.0, 0.0, -1.0), 4.0), HalfSpace((0.0, 1.5, 0.0), (-0.6, 0.8, 0.0))
POST, PLATE = Sphere((0.35, -0.45, 0.4), 0.2), Disk((0.3, -0.4, 0.9), (0.6, -0.8, 0.0), 0.25)


def cloud(turned: bool = False, shift: float = 0.0) -> VoxelGrid:
    """Return a cloud of 6 x 6 x 6 voxels; for twins with its axes exchanged or moved by a part of a voxel."""
    i, j, k = np.meshgrid(*[np.arange(6)] * 3, indexing="ij")
    sigma_t = 0.5 + 0.3 * np.cos(1.3 * i) * np.cos(0.9 * j + 1) + 0.2 * np.sin(1.1 * k)
    lower, upper = np.array([-1.5, -1.5, -2.0]), np.array([1.5, 1.5, 2.5])
    offset = shift * (upper - lower) / 6
    grid = sigma_t.transpose(2, 1, 0) if turned else sigma_t
    return VoxelGrid(grid, lower + offset, upper + offset, "nearest", 0.8, HenyeyGreenstein(0.5))


Factor = Callable[[LitMedium, np.ndarray], Any]
"""What a twin multiplies the contribution of each place with."""

_SOURCES = {
    "equiangular": "Kulla & Fajardo 2012",
    "mixed": "Veach & Guibas 1995; Kulla & Fajardo 2012",
}


def fog(phase: PhaseFunction | None = None) -> Medium:
    """Return the medium of most cases."""
    return Medium(0.1, 0.4, phase) if phase else Medium(0.1, 0.4)


def _case(
    name: str,
    title: str,
    medium: AnyMedium,
    light: Light,
    error: str,
    factor: Factor | None = None,
    *,
    twin: Callable[[], Any] | None = None,
    ray: Ray = RAY,
    exact_variance: bool = False,
    samples: int = 500_000,
    **more: Any,
) -> EstimatorCase:
    """Return the case of `Airlight`; the name begins with the placing. The twin is the subject times a factor, or another."""
    placing: Any = name.split("/")[0]

    def broken() -> Drawn:
        assert factor is not None
        return _times(factor, LitMedium(medium, ray, light, **more), placing)

    def variance() -> Any:
        uniform: Any = medium
        assert isinstance(light, PointLight)
        return single_scattering_variance(uniform, ray, light, placing)

    geometry = {key: value for key, value in more.items() if key != "shadow_rays"}
    return EstimatorCase(
        name=f"airlight/{name}",
        title=f"Airlight, {title}",
        make=lambda: Airlight(medium, ray, light, placing, **more),
        reference=lambda: single_scattering(medium, ray, light, **geometry),
        variance=variance if exact_variance else None,
        cost=(lambda: 1.0) if exact_variance else None,
        oracle="single_scattering, single_scattering_variance" if exact_variance else "single_scattering",
        source=_SOURCES.get(placing, "volume rendering equation, one-sample estimator"),
        twin=Twin(error, twin or broken),
        samples=samples,
    )


def _times(factor: Factor, lit: LitMedium, placing: Any) -> Drawn:
    """The one-sample estimator again, each contribution multiplied by an error."""
    places = placer(lit, placing)

    def draw(rng: np.random.Generator, n: int) -> Draws:
        drawn = places.sample(rng.random((n, 1)))
        inside = np.ones(n, bool) if drawn.event is None else drawn.event == 0
        t = np.where(inside, drawn.x, 0.0)
        value = lit.seen(t) * lit.scattered(t, rng)[0] / drawn.pdf * factor(lit, t)
        return Draws(np.where(inside, value, 0.0), cost=np.ones(n))

    return Drawn(draw)


def _distance(lit: LitMedium, t: np.ndarray) -> np.ndarray:
    assert isinstance(lit.light, PointLight | SpotLight)
    return np.linalg.norm(lit.points(t) - np.asarray(lit.light.position)[:, None], axis=0)


def _sigma_t(lit: LitMedium) -> float:
    uniform: Any = lit.medium
    return float(uniform.sigma_t)


def _constant(value: float) -> Factor:
    return lambda lit, t: value


def _coin(lit: LitMedium, t: np.ndarray) -> np.ndarray:
    """A branch taken half the time: one place in two is lost."""
    return (np.arange(len(t)) % 2).astype(float)


def _no_way_to_light(lit: LitMedium, t: np.ndarray) -> np.ndarray:
    return np.exp(_sigma_t(lit) * _distance(lit, t))


def _printed_denominator(lit: LitMedium, t: np.ndarray) -> np.ndarray:
    """exp(-sigma_t d^2) in the place of d^2."""
    r2 = _distance(lit, t) ** 2
    return r2 * np.exp(_sigma_t(lit) * r2)


def _albedo_in_shadow(lit: LitMedium, t: np.ndarray) -> np.ndarray:
    """A shadow ray that collides returns the albedo, not 0: T + (1 - T) albedo in the place of T."""
    T = np.exp(-_sigma_t(lit) * _distance(lit, t))
    return (T + (1 - T) * lit.albedo) / T


def _way_to_light_again(lit: LitMedium, t: np.ndarray) -> np.ndarray:
    x, distance = lit.points(t), _distance(lit, t)
    assert isinstance(lit.light, PointLight)
    w = (np.asarray(lit.light.position)[:, None] - x) / distance
    return shadow_transmittance("exact", lit.medium, x, w, distance)[0]


def _only_if_scattered(lit: LitMedium, t: np.ndarray) -> Any:
    """The estimate is added only when another free path has collided, without its probability: the mean of that."""
    return 1 - float(lit.seen(np.array([lit.length]))[0])


def _march_with_a_term_more() -> Drawn:
    """N + 1 terms with a step of length / N, as printed."""
    lit, steps = LitMedium(fog(Rayleigh()), RAY, POINT), 8
    step = lit.length / steps

    def draw(rng: np.random.Generator, n: int) -> Draws:
        value = np.zeros(n)
        for k in range(steps + 1):
            t = step * (k + rng.random(n))
            value += step * lit.seen(t) * lit.scattered(t, rng)[0]
        return Draws(value, cost=np.full(n, float(steps)))

    return Drawn(draw)


def _decoupled_case(
    name: str, title: str, medium: AnyMedium, step: float, error: str, twin: Callable[[], Any], **more: Any
) -> EstimatorCase:
    ray = Ray((0.05, 0.03, -3.0), (0.0, 0.0, 1.0), 6.0)
    return EstimatorCase(
        name=f"airlight/decoupled/{name}",
        title=f"Airlight, decoupled marching, {title}",
        make=lambda: DecoupledAirlight(medium, ray, POINT, step, **more),
        reference=lambda: single_scattering(medium, ray, POINT),
        oracle="single_scattering",
        source="Kulla & Fajardo 2012",
        twin=Twin(error, twin),
        samples=300_000,
    )


def _halved(estimator: Any) -> Drawn:
    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = estimator.draw(rng, n)
        return draws._replace(value=0.5 * np.asarray(draws.value))

    return Drawn(draw)


def _environment_case(
    name: str, title: str, medium: Medium, shape: Any, error: str, twin: Callable[[], Any], **more: Any
) -> EstimatorCase:
    sky = Environment(1.3)
    return EstimatorCase(
        name=f"airlight/environment/{name}",
        title=f"Airlight of an environment, {title}",
        make=lambda: EnvironmentAirlight(medium, RAY, sky, shape, **more),
        reference=lambda: single_scattering(medium, RAY, sky, shape=shape),
        oracle="single_scattering",
        cost=lambda: float(more.get("directions", 1)),
        source="volume rendering equation, M directions from a density",
        twin=Twin(error, twin),
        samples=300_000,
    )


def _without_its_weight(medium: Medium, shape: Any, directions: int) -> EnvironmentAirlight:
    """Isotropic directions whose weight f/p is taken for 1: those of a medium that scatters isotropically."""
    return EnvironmentAirlight(Medium(medium.sigma_a, medium.sigma_s), RAY, Environment(1.3), shape, directions)


def _along_the_ray(medium: Medium, shape: Any) -> Drawn:
    """The radiance is looked up along the camera ray, not along the direction drawn."""
    lit = LitMedium(medium, RAY, Environment(1.3), (), shape)
    places = placer(lit, "distance")

    def draw(rng: np.random.Generator, n: int) -> Draws:
        drawn = places.sample(rng.random((n, 1)))
        ahead = np.broadcast_to(RAY.direction[:, None], (3, n))
        arriving = 1.3 * lit.transmittance(lit.points(drawn.x), ahead, np.full(n, np.inf), rng)[0]
        value = lit.seen(drawn.x) * lit.albedo * lit.extinction.sigma(drawn.x) * arriving / drawn.pdf
        return Draws(value, cost=np.ones(n))

    return Drawn(draw)


def _not_divided(estimator: EnvironmentAirlight) -> Drawn:
    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = estimator.draw(rng, n)
        return draws._replace(value=estimator.directions * np.asarray(draws.value))

    return Drawn(draw)


def cases() -> list[EstimatorCase]:
    """Return the single-scattering cases."""
    forward, backward, rayleigh = fog(HenyeyGreenstein(0.6)), fog(HenyeyGreenstein(-0.7)), fog(Rayleigh())
    lobes, murky = fog(DoubleHenyeyGreenstein(0.7, -0.4, 0.65)), fog(Murky())
    rising = LinearMedium(0.3, (0.02, 0.05, 0.1), 0.7, Rayleigh())
    air = ExponentialMedium(0.4, (0.1, -0.2, -0.3), 0.8)
    through = Ray((0.05, 0.03, -3.0), (0.0, 0.0, 1.0), 6.0)
    return [
        _case(
            "equiangular/isotropic",
            "equiangular, isotropic",
            fog(),
            POINT,
            "sigma_s is missing",
            _constant(1 / 0.4),
            exact_variance=True,
        ),
        _case(
            "equiangular/forward",
            "equiangular, Henyey-Greenstein g = 0.6",
            forward,
            POINT,
            "the sign of the scattering cosine",
            twin=lambda: Airlight(fog(HenyeyGreenstein(-0.6)), RAY, POINT),
            exact_variance=True,
        ),
        _case(
            "equiangular/backward",
            "equiangular, Henyey-Greenstein g = -0.7",
            backward,
            POINT,
            "isotropic scattering for g < 0",
            twin=lambda: Airlight(fog(), RAY, POINT),
            exact_variance=True,
        ),
        _case(
            "equiangular/rayleigh",
            "equiangular, Rayleigh",
            rayleigh,
            POINT,
            "the segment starts a metre late",
            twin=lambda: Airlight(rayleigh, Ray((0.0, 0.0, -1.0), (0.0, 0.0, 1.0), 4.0), POINT),
            exact_variance=True,
        ),
        _case(
            "equiangular/lobes",
            "equiangular, two Henyey-Greenstein lobes",
            lobes,
            POINT,
            "one of the lobes is forgotten",
            twin=lambda: Airlight(fog(HenyeyGreenstein(0.7)), RAY, POINT),
        ),
        _case(
            "equiangular/murky",
            "equiangular, murky atmosphere",
            murky,
            POINT,
            "the way to the light is taken for vacuum",
            _no_way_to_light,
        ),
        _case(
            "equiangular/close",
            "equiangular, light a centimetre from the ray",
            fog(),
            CLOSE,
            "the light is two centimetres away",
            twin=lambda: Airlight(fog(), RAY, PointLight((0.0, 0.02, 0.5), 3.0)),
            exact_variance=True,
            samples=3_000_000,
        ),
        _case(
            "equiangular/endless",
            "equiangular, ray without end",
            forward,
            POINT,
            "the ray is cut at the light",
            twin=lambda: Airlight(forward, Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0), 2.5), POINT),
            ray=ENDLESS,
            exact_variance=True,
        ),
        _case(
            "equiangular/thin",
            "equiangular, thin medium",
            Medium(0.002, 0.018),
            POINT,
            "it is added only if another free path has scattered",
            _only_if_scattered,
            exact_variance=True,
        ),
        _case(
            "equiangular/linear",
            "equiangular, extinction that grows linearly",
            rising,
            POINT,
            "the way to the light has the extinction of the start",
            twin=lambda: Airlight(LinearMedium(0.3, (0.0, 0.0, 0.1), 0.7, Rayleigh()), RAY, POINT),
        ),
        _case(
            "equiangular/exponential",
            "equiangular, atmosphere",
            air,
            POINT,
            "the atmosphere is taken for homogeneous",
            twin=lambda: Airlight(Medium(0.08, 0.32), RAY, POINT),
        ),
        _case(
            "equiangular/spot",
            "equiangular, spot light with a soft edge",
            forward,
            SPOT,
            "the half angle is taken for the whole angle",
            twin=lambda: Airlight(forward, RAY, SpotLight(SPOT.position, AXIS, 3.0, 0.3, 0.15, 2)),
        ),
        _case(
            "equiangular/hard-spot",
            "equiangular, spot light with a hard edge",
            rayleigh,
            HARD_SPOT,
            "the light is taken for a point light",
            twin=lambda: Airlight(rayleigh, RAY, POINT),
        ),
        _case(
            "equiangular/sphere",
            "equiangular, in the shadow of a sphere",
            forward,
            POINT,
            "the sphere casts no shadow",
            twin=lambda: Airlight(forward, RAY, POINT),
            occluders=(POST,),
        ),
        _case(
            "equiangular/box",
            "equiangular, light in a box of fog",
            forward,
            POINT,
            "the fog is taken to fill all of space",
            twin=lambda: Airlight(forward, RAY, POINT),
            shape=BOX,
        ),
        _case(
            "free-path/isotropic",
            "free path, isotropic",
            fog(),
            POINT,
            "the flux is taken for the intensity",
            _constant(4 * np.pi),
            exact_variance=True,
            samples=1_000_000,
        ),
        _case(
            "free-path/forward",
            "free path, Henyey-Greenstein g = 0.6",
            forward,
            POINT,
            "a branch taken half the time is not divided by its probability",
            _coin,
            exact_variance=True,
            samples=1_000_000,
        ),
        _case(
            "free-path/rayleigh",
            "free path, Rayleigh",
            rayleigh,
            POINT,
            "the albedo is applied twice",
            _constant(0.8),
            exact_variance=True,
            samples=1_000_000,
        ),
        _case(
            "free-path/half-space",
            "free path, sun over a half-space",
            fog(HenyeyGreenstein(0.3)),
            SUN,
            "the irradiance is divided by 4 pi once more",
            twin=lambda: Airlight(
                fog(HenyeyGreenstein(0.3)),
                ENDLESS,
                DirectionalLight(SUN.direction, 2 / (4 * np.pi)),
                "free-path",
                (),
                GROUND,
            ),
            ray=ENDLESS,
            shape=GROUND,
        ),
        _case(
            "distance/isotropic",
            "free path that ends on the ray, isotropic",
            fog(),
            POINT,
            "a shadow ray that collides returns the albedo, not 0",
            _albedo_in_shadow,
            exact_variance=True,
        ),
        _case(
            "distance/ball",
            "free path that ends in a ball of fog, sun",
            forward,
            SUN,
            "the sun travels the other way",
            twin=lambda: Airlight(forward, RAY, DirectionalLight((-0.6, 0.0, -0.8), 2.0), "distance", (), BALL),
            shape=BALL,
        ),
        _case(
            "distance/slab",
            "free path that ends in a slab of fog, light in front of it",
            forward,
            PointLight((0.6, -0.8, -2.5), 3.0),
            "the fog is taken to fill all of space",
            twin=lambda: Airlight(forward, RAY, PointLight((0.6, -0.8, -2.5), 3.0), "distance"),
            shape=SLAB,
        ),
        _case(
            "distance/plate",
            "free path that ends on the ray, in the shadow of a disk",
            rayleigh,
            POINT,
            "a sphere of the same radius casts the shadow",
            twin=lambda: Airlight(rayleigh, RAY, POINT, "distance", (Sphere(PLATE.center, PLATE.radius),)),
            occluders=(PLATE,),
        ),
        _case(
            "uniform/rayleigh",
            "uniform, Rayleigh",
            rayleigh,
            POINT,
            "the denominator exp(-sigma_t d^2) in the place of d^2",
            _printed_denominator,
            exact_variance=True,
        ),
        _case(
            "mixed/forward",
            "equiangular or free path by a coin, Henyey-Greenstein g = 0.6",
            forward,
            POINT,
            "the density is the sum of both, not the mean",
            _constant(0.5),
        ),
        _case(
            "mixed/close",
            "equiangular or free path by a coin, light a centimetre from the ray",
            forward,
            CLOSE,
            "the light, which no free path can hit, has a share in the weights",
            _constant(0.85),
        ),
        _case(
            "mixed/spot",
            "equiangular or free path by a coin, spot light",
            rayleigh,
            SPOT,
            "the edge of the cone is hard",
            twin=lambda: Airlight(rayleigh, RAY, SpotLight(SPOT.position, AXIS, 3.0, 0.6, None, 2), "mixed"),
        ),
        _case(
            "mixed/shadows",
            "equiangular or free path by a coin, shadows of a sphere and a disk",
            rayleigh,
            POINT,
            "one of the two casts no shadow",
            twin=lambda: Airlight(rayleigh, RAY, POINT, "mixed", (POST,)),
            occluders=(POST, Disk((0.2, -0.3, -0.2), (0.6, -0.8, 0.0), 0.3)),
        ),
        _case(
            "equiangular/voxels",
            "equiangular, cloud of voxels, shadow rays cell by cell",
            cloud(),
            POINT,
            "the axes of the grid are exchanged",
            twin=lambda: Airlight(cloud(turned=True), through, POINT),
            ray=through,
            samples=300_000,
        ),
        _case(
            "equiangular/voxels/ratio",
            "equiangular, cloud of voxels, shadow rays by ratio tracking",
            cloud(),
            POINT,
            "the grid is moved by a voxel",
            twin=lambda: Airlight(cloud(shift=1.0), through, POINT, shadow_rays="ratio"),
            ray=through,
            samples=300_000,
            shadow_rays="ratio",
        ),
        _case(
            "equiangular/exponential/ratio",
            "equiangular, atmosphere, shadow rays by ratio tracking",
            air,
            POINT,
            "the medium is twice as dense on the way to the light",
            _way_to_light_again,
            shadow_rays="ratio",
        ),
        _decoupled_case(
            "homogeneous",
            "homogeneous fog, three steps",
            rayleigh,
            2.0,
            "the density is the sum of both, not the mean",
            lambda: _halved(DecoupledAirlight(rayleigh, through, POINT, 2.0)),
        ),
        _decoupled_case(
            "voxels",
            "cloud of voxels, steps of a centimetre",
            cloud(),
            0.01,
            "two steps through the whole cloud",
            lambda: DecoupledAirlight(cloud(), through, POINT, 2.25),
        ),
        _decoupled_case(
            "voxels/ratio",
            "cloud of voxels, shadow rays by ratio tracking",
            cloud(),
            0.01,
            "the axes of the grid are exchanged",
            lambda: DecoupledAirlight(cloud(turned=True), through, POINT, 0.01, shadow_rays="ratio"),
            shadow_rays="ratio",
        ),
        EstimatorCase(
            name="airlight/march/jittered",
            title="Airlight, marching with a jittered place in each of 8 steps",
            make=lambda: MarchedAirlight(rayleigh, RAY, POINT, 8, "jittered"),
            reference=lambda: single_scattering(rayleigh, RAY, POINT),
            cost=lambda: 8.0,
            oracle="single_scattering",
            source="stratified sampling of the Riemann sum",
            twin=Twin("N + 1 terms with a step of length / N", _march_with_a_term_more),
            samples=100_000,
        ),
        _environment_case(
            "ball",
            "ball of fog, directions by the phase function",
            forward,
            BALL,
            "the light is looked up along the camera ray, not along the direction drawn",
            lambda: _along_the_ray(forward, BALL),
        ),
        _environment_case(
            "four-directions",
            "ball of fog, four directions at each place",
            rayleigh,
            BALL,
            "the sum over the directions is not divided by their number",
            lambda: _not_divided(EnvironmentAirlight(rayleigh, RAY, Environment(1.3), BALL, 4)),
            directions=4,
        ),
        _environment_case(
            "uniform",
            "half-space of fog, two isotropic directions with weights",
            forward,
            GROUND,
            "the weight of an isotropic direction is taken for 1",
            lambda: _without_its_weight(forward, GROUND, 2),
            directions=2,
            proposal=Isotropic(),
        ),
    ]
