"""Single scattering at the ends of free paths, and at uniform places, against the oracle's airlight."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue.airlight.scenes import (
    BALL,
    ENDLESS,
    GROUND,
    PLATE,
    POINT,
    RAY,
    SLAB,
    airlight_case,
    constant,
    distance_to_light,
    fog,
    sigma_t_of,
)
from fogproof.catalogue.cases import EstimatorCase
from fogproof.estimators import (
    Airlight,
    LitMedium,
)
from fogproof.scene import (
    HenyeyGreenstein,
    PointLight,
    Rayleigh,
)
from fogproof.scene.lights import DirectionalLight
from fogproof.scene.occluders import Sphere

SUN = DirectionalLight((0.6, 0.0, 0.8), 2.0)


def _coin(lit: LitMedium, t: np.ndarray) -> np.ndarray:
    """A branch taken half the time: one place in two is lost."""
    return (np.arange(len(t)) % 2).astype(float)


def _printed_denominator(lit: LitMedium, t: np.ndarray) -> np.ndarray:
    """exp(-sigma_t d^2) in the place of d^2."""
    r2 = distance_to_light(lit, t) ** 2
    return r2 * np.exp(sigma_t_of(lit) * r2)


def _albedo_in_shadow(lit: LitMedium, t: np.ndarray) -> np.ndarray:
    """A shadow ray that collides returns the albedo, not 0: T + (1 - T) albedo in the place of T."""
    T = np.exp(-sigma_t_of(lit) * distance_to_light(lit, t))
    return (T + (1 - T) * lit.albedo) / T


def cases() -> list[EstimatorCase]:
    """Return the cases of free paths, of those that end on the ray, and of uniform places."""
    forward = fog(HenyeyGreenstein(0.6))
    rayleigh = fog(Rayleigh())
    return [
        airlight_case(
            name="free-path/isotropic",
            title="free path, isotropic",
            medium=fog(),
            light=POINT,
            error="the flux is taken for the intensity",
            factor=constant(4 * np.pi),
            exact_variance=True,
            samples=1_000_000,
        ),
        airlight_case(
            name="free-path/forward",
            title="free path, Henyey-Greenstein g = 0.6",
            medium=forward,
            light=POINT,
            error="a branch taken half the time is not divided by its probability",
            factor=_coin,
            exact_variance=True,
            samples=1_000_000,
        ),
        airlight_case(
            name="free-path/rayleigh",
            title="free path, Rayleigh",
            medium=rayleigh,
            light=POINT,
            error="the albedo is applied twice",
            factor=constant(0.8),
            exact_variance=True,
            samples=1_000_000,
        ),
        airlight_case(
            name="free-path/half-space",
            title="free path, sun over a half-space",
            medium=fog(HenyeyGreenstein(0.3)),
            light=SUN,
            error="the irradiance is divided by 4 pi once more",
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
        airlight_case(
            name="distance/isotropic",
            title="free path that ends on the ray, isotropic",
            medium=fog(),
            light=POINT,
            error="a shadow ray that collides returns the albedo, not 0",
            factor=_albedo_in_shadow,
            exact_variance=True,
        ),
        airlight_case(
            name="distance/ball",
            title="free path that ends in a ball of fog, sun",
            medium=forward,
            light=SUN,
            error="the sun travels the other way",
            twin=lambda: Airlight(forward, RAY, DirectionalLight((-0.6, 0.0, -0.8), 2.0), "distance", (), BALL),
            shape=BALL,
        ),
        airlight_case(
            name="distance/slab",
            title="free path that ends in a slab of fog, light in front of it",
            medium=forward,
            light=PointLight((0.6, -0.8, -2.5), 3.0),
            error="the fog is taken to fill all of space",
            twin=lambda: Airlight(forward, RAY, PointLight((0.6, -0.8, -2.5), 3.0), "distance"),
            shape=SLAB,
        ),
        airlight_case(
            name="distance/plate",
            title="free path that ends on the ray, in the shadow of a disk",
            medium=rayleigh,
            light=POINT,
            error="a sphere of the same radius casts the shadow",
            twin=lambda: Airlight(rayleigh, RAY, POINT, "distance", (Sphere(PLATE.center, PLATE.radius),)),
            occluders=(PLATE,),
        ),
        airlight_case(
            name="uniform/rayleigh",
            title="uniform, Rayleigh",
            medium=rayleigh,
            light=POINT,
            error="the denominator exp(-sigma_t d^2) in the place of d^2",
            factor=_printed_denominator,
            exact_variance=True,
        ),
    ]
