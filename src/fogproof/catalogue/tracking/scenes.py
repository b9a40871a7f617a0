"""Media and a ray that the cases of trackers share, and how such a case is made."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from fogproof.analytic import (
    coefficients,
    transmittance,
    transmittance_lookups,
    transmittance_variance,
)
from fogproof.catalogue.cases import EstimatorCase, SamplerCase, Twin
from fogproof.catalogue.twins.trackers import OtherSamples
from fogproof.contracts import Reference
from fogproof.estimators import CompiledField, FractalNoise
from fogproof.scene import (
    AnyMedium,
    ExponentialMedium,
    LinearMedium,
    PiecewiseConstantMedium,
    Procedural,
    Ray,
    VoxelGrid,
)

RAY = Ray((-0.6, -0.7, -0.5), (0.48, 0.6, 0.64), 1.75)
UP = Ray((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 2.0)
LINEAR = LinearMedium(0.9, (0.3, 0.2, 0.4))
EXPONENTIAL = ExponentialMedium(0.6, (0.2, 0.1, -0.9))
COLOURS = LinearMedium((0.9, 0.4, 0.2), ((0.3, 0.2, 0.4), (0.1, 0.1, -0.1), (0.0, 0.0, 0.1)), (0.9, 0.6, 0.3))
LAYERS = PiecewiseConstantMedium(np.linspace(0.0, 2.0, 9), (0.2, 1.0, 0.0, 2.0, 0.5, 0.1, 1.2, 0.8))
WOODCOCK = "Woodcock et al. 1965"
NOVAK = "Novák, Selle & Jarosz 2014"
WALK = "Amanatides & Woo 1987"
MILLER = "Miller, Georgiev & Jarosz 2019; Kutz et al. 2017"
RIEMANN = "Riemann sums; Euler-Maclaurin formula"
MEAN_VARIANCE_COST = "transmittance, transmittance_variance, transmittance_lookups"


def waves(x: np.ndarray) -> np.ndarray:
    """An array function, as users write them."""
    return 1 + 0.5 * np.sin(3 * x[..., 0] + 1) * np.sin(2 * x[..., 1] + x[..., 2])


@cache
def compiled_waves() -> CompiledField:
    """Return the same as a numba function, compiled once."""
    import numba

    return CompiledField(numba.njit(lambda x, y, z: 1 + 0.5 * np.sin(3 * x + 1) * np.sin(2 * y + z)))


def cloud(interpolation: Any, *channels: int) -> VoxelGrid:
    """A cloud of 8 x 6 x 10 voxels around the ray, denser in the middle, uneven everywhere."""
    rng = np.random.default_rng(20)
    x, y, z = np.meshgrid(*(np.linspace(-1, 1, n) for n in (8, 6, 10)), indexing="ij")
    sigma = (0.1 + np.exp(-2 * (x * x + y * y + z * z)))[(..., *[None] * len(channels))] * rng.uniform(
        0.3, 2.0, (8, 6, 10, *channels)
    )
    return VoxelGrid(sigma, (-1.0, -0.9, -0.8), (1.0, 1.1, 1.3), interpolation)


def noise_medium() -> Procedural:
    """Return a medium of fractal noise."""
    return FractalNoise(2.0, 1.5, octaves=3, seed=7).medium()


def transmittance_case(
    name: str,
    title: str,
    make: Callable[[], Any],
    medium: AnyMedium,
    tracking: Any,
    majorant: float,
    error: str,
    twin: Callable[[], Any],
    *,
    control: float = 0.0,
    samples: int = 1_000_000,
) -> EstimatorCase:
    """Return a case along `RAY`; majorant and control are those of the tracked part."""
    return EstimatorCase(
        name=f"tracking/{name}",
        title=title,
        make=make,
        reference=lambda: transmittance(medium, RAY),
        variance=lambda: transmittance_variance(medium, RAY, tracking, majorant, control),
        cost=lambda: transmittance_lookups(medium, RAY, tracking, majorant, control),
        oracle=MEAN_VARIANCE_COST,
        source=WOODCOCK if tracking == "delta" else NOVAK,
        twin=Twin(error, twin),
        samples=samples,
    )


def path_density(medium: AnyMedium, ray: Ray) -> Callable[[np.ndarray], Reference]:
    """Distances have the density sigma_t T, the mean of it over the channels."""

    def reference(t: np.ndarray) -> Reference:
        through = transmittance(medium, Ray(ray.origin, ray.direction, np.maximum(t, np.finfo(float).tiny)))
        sigma = coefficients(medium, ray.origin + t[:, None] * ray.direction, ray.direction).sigma_t
        value, error = sigma * through.value, sigma * through.error + 1e-14 * sigma * through.value
        if medium.channels:
            value, error = value.mean(axis=-1), error.mean(axis=-1)
        return Reference(value, error, through.method, through.source)

    return reference


def distance_case(
    name: str, title: str, make: Callable[[], Any], medium: AnyMedium, ray: Ray, source: str, error: str, twin: Any
) -> SamplerCase:
    """Return a case of distances along a ray."""

    def cdf(t: np.ndarray) -> np.ndarray:
        through = transmittance(medium, Ray(ray.origin, ray.direction, np.maximum(t, np.finfo(float).tiny))).value
        return np.where(t >= ray.length, 1.0, 1 - (through.mean(axis=-1) if medium.channels else through))

    return SamplerCase(
        name=f"tracking/{name}",
        title=title,
        make=make,
        reference=path_density(medium, ray),
        oracle="transmittance, coefficients",
        source=source,
        twin=Twin(error, lambda: OtherSamples(make(), twin)),
        options={"cdf": cdf},
        samples=500_000,
    )
