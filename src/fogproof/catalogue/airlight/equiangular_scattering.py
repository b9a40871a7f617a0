"""Single scattering at equiangular places against the oracle's airlight."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.catalogue.airlight.scenes import (
    AXIS,
    BOX,
    CLOSE,
    ENDLESS,
    POINT,
    POST,
    RAY,
    SPOT,
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
    DoubleHenyeyGreenstein,
    ExponentialMedium,
    HenyeyGreenstein,
    LinearMedium,
    Medium,
    Murky,
    PointLight,
    Ray,
    Rayleigh,
)
from fogproof.scene.lights import SpotLight

HARD_SPOT = SpotLight((0.6, -0.8, 0.5), AXIS, 3.0, 0.5)


def _no_way_to_light(lit: LitMedium, t: np.ndarray) -> np.ndarray:
    return np.exp(sigma_t_of(lit) * distance_to_light(lit, t))


def _only_if_scattered(lit: LitMedium, t: np.ndarray) -> Any:
    """The estimate is added only when another free path has collided, without its probability: the mean of that."""
    return 1 - float(lit.seen(np.array([lit.length]))[0])


def cases() -> list[EstimatorCase]:
    """Return the cases of equiangular places."""
    forward = fog(HenyeyGreenstein(0.6))
    backward = fog(HenyeyGreenstein(-0.7))
    rayleigh = fog(Rayleigh())
    lobes = fog(DoubleHenyeyGreenstein(0.7, -0.4, 0.65))
    murky = fog(Murky())
    rising = LinearMedium(0.3, (0.02, 0.05, 0.1), 0.7, Rayleigh())
    air = ExponentialMedium(0.4, (0.1, -0.2, -0.3), 0.8)
    return [
        airlight_case(
            name="equiangular/isotropic",
            title="equiangular, isotropic",
            medium=fog(),
            light=POINT,
            error="sigma_s is missing",
            factor=constant(1 / 0.4),
            exact_variance=True,
        ),
        airlight_case(
            name="equiangular/forward",
            title="equiangular, Henyey-Greenstein g = 0.6",
            medium=forward,
            light=POINT,
            error="the sign of the scattering cosine",
            twin=lambda: Airlight(fog(HenyeyGreenstein(-0.6)), RAY, POINT),
            exact_variance=True,
        ),
        airlight_case(
            name="equiangular/backward",
            title="equiangular, Henyey-Greenstein g = -0.7",
            medium=backward,
            light=POINT,
            error="isotropic scattering for g < 0",
            twin=lambda: Airlight(fog(), RAY, POINT),
            exact_variance=True,
        ),
        airlight_case(
            name="equiangular/rayleigh",
            title="equiangular, Rayleigh",
            medium=rayleigh,
            light=POINT,
            error="the segment starts a metre late",
            twin=lambda: Airlight(rayleigh, Ray((0.0, 0.0, -1.0), (0.0, 0.0, 1.0), 4.0), POINT),
            exact_variance=True,
        ),
        airlight_case(
            name="equiangular/lobes",
            title="equiangular, two Henyey-Greenstein lobes",
            medium=lobes,
            light=POINT,
            error="one of the lobes is forgotten",
            twin=lambda: Airlight(fog(HenyeyGreenstein(0.7)), RAY, POINT),
        ),
        airlight_case(
            name="equiangular/murky",
            title="equiangular, murky atmosphere",
            medium=murky,
            light=POINT,
            error="the way to the light is taken for vacuum",
            factor=_no_way_to_light,
        ),
        airlight_case(
            name="equiangular/close",
            title="equiangular, light a centimetre from the ray",
            medium=fog(),
            light=CLOSE,
            error="the light is two centimetres away",
            twin=lambda: Airlight(fog(), RAY, PointLight((0.0, 0.02, 0.5), 3.0)),
            exact_variance=True,
            samples=3_000_000,
        ),
        airlight_case(
            name="equiangular/endless",
            title="equiangular, ray without end",
            medium=forward,
            light=POINT,
            error="the ray is cut at the light",
            twin=lambda: Airlight(forward, Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0), 2.5), POINT),
            ray=ENDLESS,
            exact_variance=True,
        ),
        airlight_case(
            name="equiangular/thin",
            title="equiangular, thin medium",
            medium=Medium(0.002, 0.018),
            light=POINT,
            error="it is added only if another free path has scattered",
            factor=_only_if_scattered,
            exact_variance=True,
        ),
        airlight_case(
            name="equiangular/linear",
            title="equiangular, extinction that grows linearly",
            medium=rising,
            light=POINT,
            error="the way to the light has the extinction of the start",
            twin=lambda: Airlight(LinearMedium(0.3, (0.0, 0.0, 0.1), 0.7, Rayleigh()), RAY, POINT),
        ),
        airlight_case(
            name="equiangular/exponential",
            title="equiangular, atmosphere",
            medium=air,
            light=POINT,
            error="the atmosphere is taken for homogeneous",
            twin=lambda: Airlight(Medium(0.08, 0.32), RAY, POINT),
        ),
        airlight_case(
            name="equiangular/spot",
            title="equiangular, spot light with a soft edge",
            medium=forward,
            light=SPOT,
            error="the half angle is taken for the whole angle",
            twin=lambda: Airlight(forward, RAY, SpotLight(SPOT.position, AXIS, 3.0, 0.3, 0.15, 2)),
        ),
        airlight_case(
            name="equiangular/hard-spot",
            title="equiangular, spot light with a hard edge",
            medium=rayleigh,
            light=HARD_SPOT,
            error="the light is taken for a point light",
            twin=lambda: Airlight(rayleigh, RAY, POINT),
        ),
        airlight_case(
            name="equiangular/sphere",
            title="equiangular, in the shadow of a sphere",
            medium=forward,
            light=POINT,
            error="the sphere casts no shadow",
            twin=lambda: Airlight(forward, RAY, POINT),
            occluders=(POST,),
        ),
        airlight_case(
            name="equiangular/box",
            title="equiangular, light in a box of fog",
            medium=forward,
            light=POINT,
            error="the fog is taken to fill all of space",
            twin=lambda: Airlight(forward, RAY, POINT),
            shape=BOX,
        ),
    ]
