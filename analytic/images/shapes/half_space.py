"""The half-space, all orders of isotropic scattering."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.images.shapes.planes import cosines
from fogproof.analytic.multiple.half_space import half_space_brdf, half_space_reflectance
from fogproof.analytic.multiple.slab_by_doubling import is_isotropic
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import HalfSpace, Medium, Ray


def sky(shape: HalfSpace, medium: Medium, ray: Ray) -> Reference:
    """Return what is seen of a uniform sky: by reciprocity, what is reflected of a beam along the ray."""
    return half_space_reflectance(_albedo(medium), cosines(ray, shape.normal, shape.point, np.inf))


def parallel(shape: HalfSpace, medium: Medium, ray: Ray, travel: np.ndarray) -> Reference:
    """Return the scattered radiance under parallel light of irradiance 1 across its direction."""
    mu0 = -float(travel @ np.array(shape.normal))
    view = cosines(ray, shape.normal, shape.point, np.inf)
    if mu0 <= 0:
        return Reference(np.zeros(view.shape))
    found = half_space_brdf(_albedo(medium), min(mu0, 1.0), view)
    return Reference(mu0 * found.value, mu0 * found.error, found.method, found.source)


def _albedo(medium: Medium) -> np.ndarray:
    if not is_isotropic(medium.phase):
        raise UnsupportedError("a half-space is solved for isotropic scattering only", "phase")
    return medium.albedo
