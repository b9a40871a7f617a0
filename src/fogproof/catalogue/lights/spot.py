"""Single scattering of a spot light whose intensity falls linearly with the angle."""

from __future__ import annotations

from dataclasses import replace

from fogproof.analytic import single_scattering
from fogproof.catalogue.cases import Case, EstimatorCase, Twin
from fogproof.catalogue.lights.extents import FOG, RAY
from fogproof.estimators import Airlight
from fogproof.scene.lights import SpotLight

LIGHT = SpotLight((0.6, -0.8, 0.5), (-6 / 11, 9 / 11, 2 / 11), 3.0, 0.6, 0.2, profile="linear")


def cases() -> list[Case]:
    """Return the cases."""
    return [
        EstimatorCase(
            name="airlight/linear-spot",
            title="Airlight of a spot light that falls linearly with the angle",
            make=lambda: Airlight(FOG, RAY, LIGHT),
            reference=lambda: single_scattering(FOG, RAY, LIGHT),
            oracle="single_scattering",
            source="the spot light of Mitsuba 3; Kulla & Fajardo 2012",
            twin=Twin(
                "it falls as a smoothstep of the cosine",
                lambda: Airlight(FOG, RAY, replace(LIGHT, profile="smoothstep")),
            ),
            samples=500_000,
        )
    ]
