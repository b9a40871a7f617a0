"""The slab, all orders of scattering, any phase function."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.images.shapes.planes import azimuth, cosines, each
from fogproof.analytic.multiple.slab import slab_reflectance, slab_transmittance
from fogproof.analytic.multiple.slab_brdf import slab_brdf, slab_btdf
from fogproof.contracts import Reference
from fogproof.scene import Medium, Ray, Slab


def sky(shape: Slab, medium: Medium, ray: Ray) -> Reference:
    """Return what is seen of a uniform sky: by reciprocity, what the slab reflects and transmits of a beam along the ray."""
    mu = np.abs(cosines(ray, shape.normal, shape.point, shape.thickness))
    albedo, tau = medium.albedo, medium.sigma_t * shape.thickness
    reflected, off = each(mu, lambda m: slab_reflectance(albedo, tau, m, medium.phase))
    passed, also = each(mu, lambda m: slab_transmittance(albedo, tau, m, medium.phase))
    return Reference(reflected + passed, off + also, "reciprocity")


def parallel(shape: Slab, medium: Medium, ray: Ray, travel: np.ndarray) -> Reference:
    """Return the scattered radiance under parallel light of irradiance 1 across its direction."""
    view = cosines(ray, shape.normal, shape.point, shape.thickness)
    fall = -float(travel @ np.array(shape.normal))
    albedo, tau, mu0 = medium.albedo, medium.sigma_t * shape.thickness, min(abs(fall), 1.0)
    turn = azimuth(ray, shape.normal, travel)
    value, error = np.zeros((2, len(view)))
    for way, some in ((slab_brdf, (view > 0) == (fall > 0)), (slab_btdf, (view > 0) != (fall > 0))):
        if some.any():
            value[some], error[some] = each(
                np.abs(view[some]),
                lambda m, a, way=way: way(albedo, tau, mu0, m, medium.phase, a),
                turn[some],
            )
    return Reference(mu0 * value, mu0 * error, "slab")
