"""Legendre series: a short one, and one of 60 moments."""

from __future__ import annotations

import numpy as np

from fogproof.analytic import single_scattering
from fogproof.catalogue.cases import Case, EstimatorCase, Twin
from fogproof.catalogue.phase.directions import TILTED, case_of_directions, sampled_from
from fogproof.estimators import Airlight
from fogproof.scene import LegendreSeries, Medium, PointLight, Ray

SOURCE = "Chandrasekhar 1960, Radiative Transfer, section 48"

CLOUDY = LegendreSeries.from_coefficients((1, 2.00917, 1.56339, 0.67407, 0.22215, 0.04725, 0.00671, 0.00068, 0.00005))
"""Nine coefficients with the factor 2 l + 1, of the size those of small spheres have."""

MIRRORED = LegendreSeries(tuple(x * (-1) ** order for order, x in enumerate(CLOUDY.moments)))

LONG = LegendreSeries(tuple((0.85 ** np.arange(61)).tolist()))
"""Henyey-Greenstein with g = 0.85, cut off where it no longer goes negative."""

MEDIUM, RAY, LAMP = Medium(0.1, 0.9, CLOUDY), Ray((0, 0, 0), (0, 0, 1), 4.0), PointLight((1.0, 0.5, 2.0), 3.0)


def _without_the_factor(phase: LegendreSeries) -> LegendreSeries:
    """The moments are taken for the coefficients: no factor 2 l + 1."""
    return LegendreSeries.from_coefficients(phase.moments)


def cases() -> list[Case]:
    """Return the cases of this phase function."""
    forgotten = "the factor 2 l + 1 is forgotten"
    return [
        case_of_directions(
            name="legendre-series/short",
            title="Directions of a Legendre series of nine moments",
            phase=CLOUDY,
            source=SOURCE,
            error="the sign of the cosine: odd moments change theirs",
            sample=sampled_from(MIRRORED),
            axis=TILTED,
        ),
        case_of_directions(
            name="legendre-series/long",
            title="Directions of a Legendre series of 61 moments",
            phase=LONG,
            source=SOURCE,
            error=forgotten,
            sample=sampled_from(_without_the_factor(LONG)),
        ),
        EstimatorCase(
            name="airlight/legendre-series",
            title="Airlight, phase function by nine Legendre moments",
            make=lambda: Airlight(MEDIUM, RAY, LAMP),
            reference=lambda: single_scattering(MEDIUM, RAY, LAMP),
            oracle="single_scattering",
            source=SOURCE,
            twin=Twin(forgotten, lambda: Airlight(Medium(0.1, 0.9, _without_the_factor(CLOUDY)), RAY, LAMP)),
            samples=100_000,
        ),
    ]
