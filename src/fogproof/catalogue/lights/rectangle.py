"""Single scattering beside a rectangle that shines."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue.cases import Case
from fogproof.catalogue.lights.extents import extent_case
from fogproof.estimators.airlight.lighting import Sampled
from fogproof.scene.lights import RectangleLight

LIGHT = RectangleLight((0.4, -0.8, 0.2), (0.0, 0.0, 0.6), (0.3, 0.4, 0.0), 3.0)


def cases() -> list[Case]:
    """Return the cases."""
    return [
        extent_case(
            "rectangle-light",
            "a rectangle, directions uniform in its solid angle",
            LIGHT,
            "Ureña, Fajardo & King 2013, An area-preserving parametrization for spherical rectangles",
            "the density is that of an area without the cosine at the light",
            _without_cosine,
        )
    ]


def _without_cosine(drawn: Sampled, _x: np.ndarray) -> Sampled:
    normal = np.cross(LIGHT.edge_u, LIGHT.edge_v)
    cosine = -(normal @ drawn.w) / float(np.linalg.norm(normal))
    return drawn._replace(arriving=drawn.arriving / np.maximum(cosine, 1e-6))
