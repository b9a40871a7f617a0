"""Single scattering at places drawn one way or the other, by the balance heuristic."""

from __future__ import annotations

from fogproof.catalogue.airlight.scenes import (
    AXIS,
    CLOSE,
    POINT,
    POST,
    RAY,
    SPOT,
    airlight_case,
    constant,
    fog,
)
from fogproof.catalogue.cases import EstimatorCase
from fogproof.estimators import (
    Airlight,
)
from fogproof.scene import (
    HenyeyGreenstein,
    Rayleigh,
)
from fogproof.scene.lights import SpotLight
from fogproof.scene.occluders import Disk


def cases() -> list[EstimatorCase]:
    """Return the cases of multiple importance sampling."""
    forward = fog(HenyeyGreenstein(0.6))
    rayleigh = fog(Rayleigh())
    return [
        airlight_case(
            name="mixed/forward",
            title="equiangular or free path by a coin, Henyey-Greenstein g = 0.6",
            medium=forward,
            light=POINT,
            error="the density is the sum of both, not the mean",
            factor=constant(0.5),
        ),
        airlight_case(
            name="mixed/close",
            title="equiangular or free path by a coin, light a centimetre from the ray",
            medium=forward,
            light=CLOSE,
            error="the light, which no free path can hit, has a share in the weights",
            factor=constant(0.85),
        ),
        airlight_case(
            name="mixed/spot",
            title="equiangular or free path by a coin, spot light",
            medium=rayleigh,
            light=SPOT,
            error="the edge of the cone is hard",
            twin=lambda: Airlight(rayleigh, RAY, SpotLight(SPOT.position, AXIS, 3.0, 0.6, None, 2), "mixed"),
        ),
        airlight_case(
            name="mixed/shadows",
            title="equiangular or free path by a coin, shadows of a sphere and a disk",
            medium=rayleigh,
            light=POINT,
            error="one of the two casts no shadow",
            twin=lambda: Airlight(rayleigh, RAY, POINT, "mixed", (POST,)),
            occluders=(POST, Disk((0.2, -0.3, -0.2), (0.6, -0.8, 0.0), 0.3)),
        ),
    ]
