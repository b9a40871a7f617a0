"""Random walks against exact moments and counts of collisions."""

from __future__ import annotations

import numpy as np

from fogproof import analytic
from fogproof.catalogue.cases import EstimatorCase
from fogproof.catalogue.multiple.builders import (
    paths_case,
    scaled,
)
from fogproof.contracts import Reference
from fogproof.estimators import (
    PointSourceWalks,
    RandomFlights,
    RodWalks,
    ScatteringsUnderUniformSky,
)
from fogproof.scene import HenyeyGreenstein, Medium
from fogproof.scene.shapes import Box


def _pair(one: Reference, two: Reference) -> Reference:
    value, error = np.array([one.value, two.value]), np.array([one.error, two.error])
    return Reference(value, error, one.method, one.source)


def cases() -> list[EstimatorCase]:
    """Return the cases of random walks."""
    lobe = HenyeyGreenstein(0.6)
    radii = (0.5, 1.0, 5.0)
    fog = Medium(0.3, 2.0, HenyeyGreenstein(0.8))
    box = Box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))
    return [
        paths_case(
            name="walks/flights",
            title="Where photons are after seven flights",
            make=lambda: RandomFlights(7, lobe),
            reference=lambda: _pair(analytic.mean_displacement(7, 0.6), analytic.mean_square_displacement(7, 0.6)),
            oracle="mean_displacement, mean_square_displacement",
            error="the sign of the scattering cosine",
            twin=lambda: RandomFlights(7, HenyeyGreenstein(-0.6)),
            source="Chandrasekhar 1943",
        ),
        paths_case(
            name="walks/point-source",
            title="Collisions around a point source in an infinite medium",
            make=lambda: PointSourceWalks(0.9, radii),
            reference=lambda: analytic.point_source_collisions(0.9, np.array(radii)),
            oracle="point_source_collisions",
            error="a collision absorbs before it is counted",
            twin=lambda: scaled(PointSourceWalks(0.9, radii), 0.9),
            source="Case, de Hoffmann & Placzek 1953",
        ),
        paths_case(
            name="walks/point-source-forward",
            title="Collisions around a point source where scattering goes forwards",
            make=lambda: PointSourceWalks(0.9, radii, lobe),
            reference=lambda: analytic.point_source_collisions(0.9, np.array(radii), lobe),
            oracle="point_source_collisions",
            error="scattering is isotropic",
            twin=lambda: PointSourceWalks(0.9, radii),
            source="McCormick & Kuscer 1966",
        ),
        paths_case(
            name="walks/rod",
            title="What comes back from a rod, and what passes it",
            make=lambda: RodWalks(0.9, 2.0, 0.5),
            reference=lambda: _pair(analytic.rod_reflectance(0.9, 2.0, 0.5), analytic.rod_transmittance(0.9, 2.0, 0.5)),
            oracle="rod_reflectance, rod_transmittance",
            error="a share g goes on forwards, not (1 + g)/2",
            twin=lambda: RodWalks(0.9, 2.0, 0.0),
            source="Schuster 1905",
        ),
        paths_case(
            name="walks/scatterings",
            title="How often light of a uniform sky scatters in a box: 4 V sigma_s / S",
            make=lambda: ScatteringsUnderUniformSky(fog, box),
            reference=lambda: analytic.mean_scatterings(box, 2.0),
            oracle="mean_scatterings",
            error="absorption counts as scattering",
            twin=lambda: ScatteringsUnderUniformSky(Medium(0.0, 2.3, HenyeyGreenstein(0.8)), box),
            source="Blanco & Fournier 2003",
        ),
    ]
