"""Single scattering under a picture of the sky, in a layer of fog."""

from __future__ import annotations

import numpy as np

from fogproof.analytic import single_scattering
from fogproof.catalogue.cases import Case, EstimatorCase, Twin
from fogproof.estimators import Airlight
from fogproof.scene import HenyeyGreenstein, Medium, Ray
from fogproof.scene.lights import EnvironmentMap
from fogproof.scene.shapes import Slab

FOG = Medium(0.1, 0.4, HenyeyGreenstein(0.5))
RAY = Ray((0.2, -0.3, -2.0), (0.0, 0.6, 0.8), 5.0)
LAYER = Slab((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 1.5)
SOURCE = "Pharr, Jakob & Humphreys 2016, section 14.2.4"


def _sky() -> np.ndarray:
    """A blue sky brighter at the horizon, a sun beside +x, and a dark ground."""
    image = np.zeros((6, 8))
    image[:3] = np.array([0.5, 0.8, 1.3])[:, None]
    image[1, 0] = 30.0
    image[3:, 2] = 0.2
    return image


SKY = EnvironmentMap(_sky(), 2.0)


def cases() -> list[Case]:
    """Return the cases."""
    turned = EnvironmentMap(np.roll(_sky(), 4, axis=1), 2.0)
    return [
        EstimatorCase(
            name="airlight/environment-map",
            title="Airlight of a picture of the sky in a layer of fog, directions by the power of its pixels",
            make=lambda: Airlight(FOG, RAY, SKY, "distance", shape=LAYER),
            reference=lambda: single_scattering(FOG, RAY, SKY, shape=LAYER),
            oracle="single_scattering",
            source=SOURCE,
            twin=Twin(
                "the picture is half a turn off: its seam lies at -x",
                lambda: Airlight(FOG, RAY, turned, "distance", shape=LAYER),
            ),
            samples=500_000,
        )
    ]
