"""Single scattering beside a disk that shines."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue.cases import Case
from fogproof.catalogue.lights.extents import extent_case
from fogproof.estimators.airlight.lighting import Sampled
from fogproof.scene.lights import DiskLight

LIGHT = DiskLight((0.6, -0.8, 0.5), (-0.6, 0.8, 0.0), 0.4, 3.0)


def cases() -> list[Case]:
    """Return the cases."""
    return [
        extent_case(
            "disk-light",
            "a disk, places uniform on it",
            LIGHT,
            "Shirley, Wang & Zimmerman 1996, Monte Carlo techniques for direct lighting calculations",
            "the intensity of the whole disk arrives from its centre",
            _from_the_centre,
        )
    ]


def _from_the_centre(drawn: Sampled, x: np.ndarray) -> Sampled:
    to = np.asarray(LIGHT.center)[:, None] - x
    square = np.sum(to * to, axis=0)
    area = np.pi * LIGHT.radius * LIGHT.radius  # and the cosine at the light is forgotten with it
    return Sampled(to / np.sqrt(square), np.sqrt(square), 3.0 * area / square)
