"""Single scattering beside a sphere that shines."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue.cases import Case
from fogproof.catalogue.lights.extents import extent_case
from fogproof.estimators.airlight.lighting import Sampled
from fogproof.scene.lights import SphereLight

LIGHT = SphereLight((0.6, -0.8, 0.5), 0.4, 3.0)


def cases() -> list[Case]:
    """Return the cases."""
    return [
        extent_case(
            "sphere-light",
            "a sphere, directions uniform in its cone",
            LIGHT,
            "Shirley, Wang & Zimmerman 1996, Monte Carlo techniques for direct lighting calculations",
            "the shadow ray ends at the far side of the sphere",
            _to_the_far_side,
        )
    ]


def _to_the_far_side(drawn: Sampled, x: np.ndarray) -> Sampled:
    towards = np.sum(drawn.w * (np.asarray(LIGHT.center)[:, None] - x), axis=0)
    return drawn._replace(distance=2 * towards - drawn.distance)
