"""Von Mises-Fisher: broad, sharp, and backward."""

from __future__ import annotations

import numpy as np

from fogproof.analytic import single_scattering
from fogproof.catalogue.cases import Case, EstimatorCase, Twin
from fogproof.catalogue.phase.directions import TILTED, about_z, case_of_directions, sampled_from
from fogproof.estimators import Airlight, Directions
from fogproof.scene import HenyeyGreenstein, Medium, PointLight, Ray, VonMisesFisher

SOURCE = "Fisher 1953; Jakob 2012, Numerically stable sampling of the von Mises-Fisher distribution"

BROAD, SHARP, BACKWARD = VonMisesFisher(1.5), VonMisesFisher(400.0), VonMisesFisher(-6.0)
MEDIUM, RAY, LAMP = Medium(0.1, 0.9, BACKWARD), Ray((0, 0, 0), (0, 0, 1), 4.0), PointLight((1.0, 0.5, 2.0), 3.0)


def _half_of_the_exponent(_sampler: Directions, u: np.ndarray) -> np.ndarray:
    """exp(-kappa) in place of exp(-2 kappa) in the inverse."""
    kappa = BROAD.kappa
    mu = 1 + np.log(u[:, 0] + (1 - u[:, 0]) * np.exp(-kappa)) / kappa
    return about_z(np.clip(mu, -1, 1), u[:, 1])


def _as_on_the_plane(sampler: Directions, x: np.ndarray) -> np.ndarray:
    """The density of a peak so narrow that the sphere is flat: kappa/(2 pi) exp(-kappa theta^2/2)."""
    half_chord = np.linalg.norm(x - np.asarray(sampler.axis), axis=1) / 2
    return SHARP.kappa / (2 * np.pi) * np.exp(-SHARP.kappa * (2 * np.arcsin(np.minimum(half_chord, 1))) ** 2 / 2)


def cases() -> list[Case]:
    """Return the cases of this phase function."""
    wrong = Medium(0.1, 0.9, VonMisesFisher(6.0))
    return [
        case_of_directions(
            name="von-mises-fisher/broad",
            title="Von Mises-Fisher directions, kappa = 1.5",
            phase=BROAD,
            source=SOURCE,
            error="exp(-kappa) in place of exp(-2 kappa) in the inverse",
            sample=_half_of_the_exponent,
        ),
        case_of_directions(
            name="von-mises-fisher/sharp",
            title="Von Mises-Fisher directions, kappa = 400",
            phase=SHARP,
            source=SOURCE,
            error="the density of a normal distribution on the tangent plane",
            pdf=_as_on_the_plane,
            axis=TILTED,
        ),
        case_of_directions(
            name="von-mises-fisher/backward",
            title="Von Mises-Fisher directions, kappa = -6",
            phase=BACKWARD,
            source=SOURCE,
            error="Henyey-Greenstein of the same mean cosine is sampled",
            sample=sampled_from(HenyeyGreenstein(-5 / 6)),
            axis=TILTED,
        ),
        EstimatorCase(
            name="airlight/von-mises-fisher",
            title="Airlight, von Mises-Fisher scattering with kappa = -6",
            make=lambda: Airlight(MEDIUM, RAY, LAMP),
            reference=lambda: single_scattering(MEDIUM, RAY, LAMP),
            oracle="single_scattering",
            source=SOURCE,
            twin=Twin("kappa < 0 scatters forward", lambda: Airlight(wrong, RAY, LAMP)),
            samples=100_000,
        ),
    ]
