"""The rectangle that shines: directions uniform in the solid angle that it fills (Ureña, Fajardo & King 2013)."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.airlight.lighting import Sampled
from fogproof.estimators.grey import grey
from fogproof.scene.lights import RectangleLight


def sample(light: RectangleLight, x: np.ndarray, u: np.ndarray) -> Sampled:
    """Return directions uniform in the spherical rectangle from points x (3, n), from uniforms u (n, 2); none from behind.

    Source: Ureña, Fajardo & King 2013, An area-preserving parametrization for spherical rectangles.
    """
    a, b = np.asarray(light.edge_u), np.asarray(light.edge_v)
    wide, high = float(np.sqrt(a @ a)), float(np.sqrt(b @ b))
    ex, ey = a / wide, b / high
    ez = np.cross(ex, ey)
    out = np.asarray(light.corner)[:, None] - x
    x0, y0, z0 = ex @ out, ey @ out, ez @ out  # of the corner, seen from the point; z0 < 0 in front
    lit = z0 < 0
    z0 = np.where(lit, z0, -1.0)
    x1, y1 = x0 + wide, y0 + high
    with np.errstate(divide="ignore", invalid="ignore"):
        # z components of the normals of the four planes through the point and an edge, and the angles between the planes
        n0, n1, n2, n3 = -y0 / np.hypot(y0, z0), x1 / np.hypot(x1, z0), y1 / np.hypot(y1, z0), -x0 / np.hypot(x0, z0)
        g0, g1, g2, g3 = (np.arccos(np.clip(-p * q, -1, 1)) for p, q in ((n0, n1), (n1, n2), (n2, n3), (n3, n0)))
        solid = g0 + g1 + g2 + g3 - 2 * np.pi
        phi = u[:, 0] * solid - g2 - g3 + 2 * np.pi
        f = (np.cos(phi) * n0 - n2) / np.sin(phi)
        cu = np.where(f > 0, 1.0, -1.0) / np.sqrt(f * f + n0 * n0)
        cu = np.clip(np.where(np.isnan(cu), 0.0, cu), -1, 1)
        xu = np.clip(-(cu * z0) / np.maximum(np.sqrt(1 - cu * cu), 1e-12), x0, x1)
        d = np.sqrt(xu * xu + z0 * z0)
        h0, h1 = y0 / np.sqrt(d * d + y0 * y0), y1 / np.sqrt(d * d + y1 * y1)
        h = h0 + u[:, 1] * (h1 - h0)
        yv = np.where(h * h < 1 - 1e-12, h * d / np.sqrt(np.maximum(1 - h * h, 1e-300)), y1)
    yv = np.clip(yv, y0, y1)
    to = xu * ex[:, None] + yv * ey[:, None] + z0 * ez[:, None]
    way = np.sqrt(np.sum(to * to, axis=0))
    return Sampled(to / way, way, grey("radiance", light.radiance) * np.where(lit, np.maximum(solid, 0.0), 0.0))


def focus(light: RectangleLight) -> tuple[float, float, float]:
    """Return its centre."""
    x, y, z = np.asarray(light.corner) + 0.5 * (np.asarray(light.edge_u) + np.asarray(light.edge_v))
    return float(x), float(y), float(z)


def breadth(light: RectangleLight) -> float:
    """Return half of its shorter side [m]."""
    return 0.5 * float(min(np.linalg.norm(light.edge_u), np.linalg.norm(light.edge_v)))


def met(light: RectangleLight, origin: np.ndarray, direction: np.ndarray) -> float:
    """Return the distance at which a ray meets the rectangle, from either side, inf if it does not [m]."""
    a, b = np.asarray(light.edge_u), np.asarray(light.edge_v)
    normal, out = np.cross(a, b), np.asarray(light.corner) - origin
    rise = float(normal @ direction)
    if rise == 0:
        return np.inf
    t = float(normal @ out) / rise
    there = t * direction - out
    inside = 0 <= there @ a <= a @ a and 0 <= there @ b <= b @ b
    return t if t > 0 and inside else np.inf
