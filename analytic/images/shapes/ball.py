"""The ball, all orders of isotropic scattering."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.images.shapes.planes import each
from fogproof.analytic.multiple.ball import ball_radiance
from fogproof.analytic.multiple.slab_by_doubling import is_isotropic
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import Ball, Medium, Ray


def sky(shape: Ball, medium: Medium, ray: Ray) -> Reference:
    """Return what is seen of a uniform sky through the ball and past it."""
    if not is_isotropic(medium.phase):
        raise UnsupportedError("a ball is solved for isotropic scattering only", "phase")
    q = ray.origin - np.array(shape.center)
    if (np.linalg.norm(q, axis=-1) < shape.radius).any():
        raise UnsupportedError("multiple scattering is known to a camera outside the ball only", "camera")
    impact = np.linalg.norm(np.cross(q, ray.direction), axis=-1)
    ahead = np.sum(q * ray.direction, axis=-1) < 0
    value, error = np.ones(ray.shape), np.zeros(ray.shape)
    some = ahead & (impact < shape.radius)
    if some.any():
        sigma = float(medium.sigma_t)
        value[some], error[some] = each(
            impact[some], lambda p: ball_radiance(float(medium.albedo), sigma * shape.radius, sigma * p)
        )
    return Reference(value, error, "ball")
