"""The rectangle that shines, as an integral over its area: the solid angle of a piece dA at r is h dA/r^3, h the height above it.

Seen from close by that has a peak at the nearest point of the rectangle, as wide as the distance delta of that. The rectangle is
cut there, and a = delta sinh(s) along each axis makes the peak as wide as 1 in s.
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.airlight.flat_lights import crossing, plane_extent
from fogproof.analytic.airlight.incident import Extent, Incident
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.scene.lights import RectangleLight


def incident(light: RectangleLight, x: np.ndarray, nodes: int) -> Incident:
    """Return Gauss-Legendre in s on both sides of the nearest point, along both axes."""
    corner, axes, lengths = _frame(light)
    place = (x - corner) @ axes.T  # (m, 3): along u, along v, height
    height = place[:, 2]
    nearest = np.clip(place[:, :2], 0.0, lengths)
    delta = np.sqrt(np.sum((place[:, :2] - nearest) ** 2, axis=1) + height**2)
    delta = np.maximum(delta, 1e-300)
    (u, du), (v, dv) = (_graded(nearest[:, k], lengths[k], delta, nodes) for k in (0, 1))
    du_, dv_ = u - place[:, :1], v - place[:, 1:2]
    # (m, k, k): differences from x, and the solid angle
    r2 = du_[:, :, None] ** 2 + dv_[:, None, :] ** 2 + height[:, None, None] ** 2
    r = np.sqrt(r2)
    weight = np.maximum(height, 0.0)[:, None, None] * du[:, :, None] * dv[:, None, :] / (r2 * r)
    local = np.stack(
        [
            np.broadcast_to(du_[:, :, None], r.shape),
            np.broadcast_to(dv_[:, None, :], r.shape),
            np.broadcast_to(-height[:, None, None], r.shape),
        ],
        axis=-1,
    )
    shape = (len(x), r.shape[1] * r.shape[2])
    w = (local / r[..., None]).reshape(*shape, 3) @ axes
    return Incident(w, r.reshape(shape), np.where(r > 0, weight, 0.0).reshape(shape))


def extent(light: RectangleLight, ray: FlatRays) -> Extent:
    """Return where rays meet the rectangle, and where they cross its plane: behind it is dark."""
    corner, axes, lengths = _frame(light)
    t, there = crossing(ray, corner, axes[2])
    along = there @ axes[:2].T
    inside = np.all((along >= 0) & (along <= lengths), axis=1)
    center = corner + 0.5 * (lengths @ axes[:2])
    return plane_extent(ray, center, axes[2], 0.5 * float(np.linalg.norm(lengths)), inside, t)


def _graded(nearest: np.ndarray, length: float, delta: np.ndarray, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Return places in [0, length] and their weights, (m, 2 nodes) each, dense as delta around the nearest."""
    y, weights = np.polynomial.legendre.leggauss(nodes)
    places, steps = [], []
    for sign, room in ((-1.0, nearest), (1.0, length - nearest)):
        last = np.arcsinh(room / delta)[:, None]
        s = last * (0.5 * (y + 1))
        places.append(nearest[:, None] + sign * delta[:, None] * np.sinh(s))
        steps.append(delta[:, None] * np.cosh(s) * (0.5 * last * weights))
    return np.concatenate(places, axis=1), np.concatenate(steps, axis=1)


def _frame(light: RectangleLight) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the corner, the rows u, v and normal (3, 3), and the lengths of the sides (2,)."""
    u, v = np.array(light.edge_u), np.array(light.edge_v)
    lengths = np.array([np.linalg.norm(u), np.linalg.norm(v)])
    e1 = u / lengths[0]
    e2 = v / lengths[1]
    normal = np.cross(e1, e2)
    return np.array(light.corner), np.stack([e1, e2, normal / np.linalg.norm(normal)]), lengths
