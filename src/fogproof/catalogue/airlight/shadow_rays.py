"""Single scattering whose shadow rays cross a cloud: cell by cell, or by ratio tracking."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue.airlight.scenes import (
    POINT,
    airlight_case,
    cloud,
    distance_to_light,
)
from fogproof.catalogue.cases import EstimatorCase
from fogproof.estimators import (
    Airlight,
    LitMedium,
    shadow_transmittance,
)
from fogproof.scene import (
    ExponentialMedium,
    PointLight,
    Ray,
)


def _way_to_light_again(lit: LitMedium, t: np.ndarray) -> np.ndarray:
    x, distance = lit.points(t), distance_to_light(lit, t)
    assert isinstance(lit.light, PointLight)
    w = (np.asarray(lit.light.position)[:, None] - x) / distance
    return shadow_transmittance("exact", lit.medium, x, w, distance)[0]


def cases() -> list[EstimatorCase]:
    """Return the cases of shadow rays."""
    air = ExponentialMedium(0.4, (0.1, -0.2, -0.3), 0.8)
    through = Ray((0.05, 0.03, -3.0), (0.0, 0.0, 1.0), 6.0)
    return [
        airlight_case(
            name="equiangular/voxels",
            title="equiangular, cloud of voxels, shadow rays cell by cell",
            medium=cloud(),
            light=POINT,
            error="the axes of the grid are exchanged",
            twin=lambda: Airlight(cloud(turned=True), through, POINT),
            ray=through,
            samples=300_000,
        ),
        airlight_case(
            name="equiangular/voxels/ratio",
            title="equiangular, cloud of voxels, shadow rays by ratio tracking",
            medium=cloud(),
            light=POINT,
            error="the grid is moved by a voxel",
            twin=lambda: Airlight(cloud(shift=1.0), through, POINT, shadow_rays="ratio"),
            ray=through,
            samples=300_000,
            shadow_rays="ratio",
        ),
        airlight_case(
            name="equiangular/exponential/ratio",
            title="equiangular, atmosphere, shadow rays by ratio tracking",
            medium=air,
            light=POINT,
            error="the medium is twice as dense on the way to the light",
            factor=_way_to_light_again,
            shadow_rays="ratio",
        ),
    ]
