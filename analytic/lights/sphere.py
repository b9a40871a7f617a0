"""The sphere that shines: from outside it fills a cone of directions.

With D the distance of the centre, R the radius and E = sqrt(D^2 - R^2) the length of the tangents, the direction at the angle theta
from the centre meets the sphere at r = D cos(theta) - sqrt(R^2 - D^2 sin^2(theta)), which has a root at the rim. With
cos(theta) = (E/D) cosh(s) the distance is r = E exp(-s) and the solid angle (E/D) sinh(s) ds dphi, 0 <= s <= asinh(R/E): both are
entire, for every distance.
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.airlight.incident import Extent, Incident
from fogproof.analytic.arithmetic.error_free import TINY
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.scene.lights import SphereLight


def incident(light: SphereLight, x: np.ndarray, nodes: int) -> Incident:
    """Return Gauss-Legendre in s times equal steps in the azimuth, in which everything is periodic."""
    axis = np.array(light.center) - x
    D = np.linalg.norm(axis, axis=1)
    axis = axis / np.maximum(D, TINY)[:, None]
    room = np.maximum((D - light.radius) * (D + light.radius), 0.0)
    E = np.sqrt(np.maximum(room, 1e-300))[:, None]
    last = np.arcsinh(light.radius / E)
    y, weights = np.polynomial.legendre.leggauss(nodes)
    s = last * (0.5 * (y + 1))
    cosine, r = np.minimum((E / D[:, None]) * np.cosh(s), 1.0), E * np.exp(-s)
    solid = (E / D[:, None]) * np.sinh(s) * (0.5 * last * weights)
    # 1 - cos^2 = (R^2 - E^2 sinh^2 s)/D^2: what cosh would cancel near the axis
    sine = np.sqrt(np.maximum((light.radius - E * np.sinh(s)) * (light.radius + E * np.sinh(s)), 0.0)) / D[:, None]
    phi = (np.arange(2 * nodes) + 0.5) * (np.pi / nodes)
    e1, e2 = _frame(axis)
    ring = np.cos(phi)[:, None] * e1[:, None, :] + np.sin(phi)[:, None] * e2[:, None, :]
    w = cosine[:, :, None, None] * axis[:, None, None, :] + sine[:, :, None, None] * ring[:, None, :, :]
    weight = np.where(room[:, None] > 0, solid, 0.0)[:, :, None] * np.full(len(phi), np.pi / nodes)
    shape = (len(x), nodes * len(phi))
    distance = np.broadcast_to(r[:, :, None], weight.shape)
    return Incident(w.reshape(*shape, 3), distance.reshape(shape), weight.reshape(shape))


def extent(light: SphereLight, ray: FlatRays) -> Extent:
    """Return where rays meet the sphere; nothing else changes suddenly."""
    away = np.array(light.center) - ray.origin
    foot = np.sum(away * ray.direction, axis=1)
    nearest = np.linalg.norm(away - foot[:, None] * ray.direction, axis=1)
    half = np.sqrt(np.maximum((light.radius - nearest) * (light.radius + nearest), 0.0))
    met = (nearest < light.radius) & (foot + half > 0)
    end = np.where(met, np.maximum(foot - half, 0.0), np.inf)
    return Extent(end, np.empty((len(foot), 0)), foot, np.maximum(nearest, light.radius))


def _frame(axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return two unit vectors (m, 3) each that complete unit vectors (m, 3)."""
    helper = np.eye(3)[np.argmin(np.abs(axis), axis=1)]
    e1 = np.cross(axis, helper)
    e1 = e1 / np.maximum(np.linalg.norm(e1, axis=1), TINY)[:, None]
    return e1, np.cross(axis, e1)
