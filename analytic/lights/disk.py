"""The disk that shines, in polar coordinates about the foot of the point that is lit.

At the height h above its plane the direction to the place at the distance rho from the foot has the cosine h/r to the normal, and
the solid angle is h rho drho dphi/r^3. With rho = h sinh(s) that is sinh(s)/cosh(s)^2 ds dphi. From a foot in the disk all azimuths
are seen; from one at rho_0 > R those with |sin(phi)| <= R/rho_0, and sin(phi) = (R/rho_0) sin(psi) takes the roots at both ends
away.
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.airlight.flat_lights import crossing, plane_extent
from fogproof.analytic.airlight.incident import Extent, Incident
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.scene.lights import DiskLight


def incident(light: DiskLight, x: np.ndarray, nodes: int) -> Incident:
    """Return Gauss-Legendre in s and psi, or equal steps of the azimuth where the foot is in the disk."""
    R, normal = light.radius, np.array(light.normal)
    out = x - np.array(light.center)
    height = out @ normal
    aside = out - height[:, None] * normal
    foot = np.linalg.norm(aside, axis=1)
    inwards = np.where(foot[:, None] > 0, -aside / np.maximum(foot, 1e-300)[:, None], _any_across(normal))
    across = np.cross(normal, inwards)
    h = np.maximum(height, 1e-300)
    phi, dphi, near, far = _azimuths(foot, R, 2 * nodes)
    y, weights = np.polynomial.legendre.leggauss(nodes)
    first, last = np.arcsinh(near / h[:, None]), np.arcsinh(far / h[:, None])
    s = first[..., None] + (last - first)[..., None] * (0.5 * (y + 1))  # (m, azimuths, nodes)
    weight = (
        (0.5 * (last - first))[..., None]
        * weights
        * dphi[..., None]
        * np.tanh(s)
        / np.cosh(s)
        * (height > 0)[:, None, None]
    )
    r = h[:, None, None] * np.cosh(s)
    flat = np.cos(phi)[..., None] * inwards[:, None, :] + np.sin(phi)[..., None] * across[:, None, :]
    w = np.tanh(s)[..., None] * flat[:, :, None, :] - (1 / np.cosh(s))[..., None] * normal
    shape = (len(x), s.shape[1] * s.shape[2])
    return Incident(w.reshape(*shape, 3), r.reshape(shape), weight.reshape(shape))


def extent(light: DiskLight, ray: FlatRays) -> Extent:
    """Return where rays meet the disk, and where they cross its plane: behind it is dark."""
    center, normal = np.array(light.center), np.array(light.normal)
    t, there = crossing(ray, center, normal)
    return plane_extent(ray, center, normal, light.radius, np.linalg.norm(there, axis=1) <= light.radius, t)


def _azimuths(foot: np.ndarray, R: float, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return azimuths from the direction to the centre, their weights, and where the disk begins and ends there, (m, count)."""
    rho = foot[:, None]
    steps = (np.arange(count) + 0.5) * (2 * np.pi / count)
    y, weights = np.polynomial.legendre.leggauss(count)
    psi, dpsi = 0.5 * np.pi * y, 0.5 * np.pi * weights
    outside = rho > R
    share = np.where(outside, R / np.where(outside, rho, 1.0), 0.0)
    phi = np.where(outside, np.arcsin(share * np.sin(psi)), steps)
    cosine = np.cos(phi)
    dphi = np.where(outside, share * np.cos(psi) / cosine * dpsi, 2 * np.pi / count)
    half = np.where(outside, R * np.cos(psi), np.sqrt(np.maximum(R * R - (rho * np.sin(phi)) ** 2, 0.0)))
    far = rho * cosine + half
    near = np.where(outside, np.maximum(rho * cosine - half, 0.0), 0.0)
    return phi, dphi, near, np.maximum(far, near)


def _any_across(normal: np.ndarray) -> np.ndarray:
    """Return a unit vector at a right angle to a unit vector (3,)."""
    w = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    across: np.ndarray = w / np.linalg.norm(w)
    return across
