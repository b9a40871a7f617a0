"""Airlight of a constant environment in a homogeneous medium that fills a convex shape.

    L = sigma_s L_env int exp(-sigma_t (t - t_enter)) int f_p(mu) exp(-sigma_t d(t, w)) dw dt        [W/(m^2 sr)]

d is the way from the point at t back along w to the boundary. Directions are taken around the ray, mu = tanh(s) and the
azimuth phi: the trapezoidal rule in both is spectrally accurate for smooth shapes, for every g. Along the ray, t runs as
y^2 (3 - 2 y), which softens the ends, in Gauss-Legendre nodes. The error is estimated from rules half as fine.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fogproof.analytic.convex_shapes import chord, through
from fogproof.analytic.error_free import EPS, TINY
from fogproof.analytic.panel_rule import NODES, WEIGHTS
from fogproof.analytic.phase_functions import phase_pdf
from fogproof.errors import UnsupportedError
from fogproof.scene import AnyMedium, Medium, Ray
from fogproof.scene.lights import Environment
from fogproof.scene.occluders import Occluder
from fogproof.scene.shapes import Shape, Unbounded

METHOD = "trapezoidal rule over directions, Gauss-Legendre along the ray"
SOURCE = "Beer's law along both ways, integrated"

STEP = 0.125
"""Of s = atanh(mu)."""

REACH = 19.0
"""Largest |s|: beyond, 1 - |mu| < 1e-16."""

AZIMUTHS = 64
PANELS = 4


def environment_light(
    medium: AnyMedium, ray: Ray, light: Environment, shape: Shape, occluders: Sequence[Occluder]
) -> tuple[np.ndarray, np.ndarray, str, str]:
    """Return the radiance (n, channels) along the flattened rays, its estimated error, method and source."""
    if not isinstance(medium, Medium) or occluders:
        raise UnsupportedError(
            "single scattering of an environment needs a homogeneous Medium and no occluders", "light"
        )
    sigma = np.atleast_1d(medium.sigma_t)
    value, error = np.zeros((2, ray.length.size, len(sigma)))
    if isinstance(shape, Unbounded):
        return value, error, "no light arrives from infinitely far", SOURCE
    inside = chord(shape, ray)
    origin, d = ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3)
    s = STEP * np.arange(-round(REACH / STEP), round(REACH / STEP) + 1)
    f = phase_pdf(medium.phase, np.tanh(s))
    directions = np.stack([STEP * f.value / np.cosh(s) ** 2, STEP * f.error / np.cosh(s) ** 2])
    with np.errstate(all="ignore"):
        for i in range(len(value)):
            start, end = inside.start[i], inside.end[i]
            if end > start:
                # An endless ray is cut where nothing is left of it.
                end = min(end, start + 745 / sigma.min()) if sigma.min() > 0 else end
                value[i], error[i] = _along(shape, origin[i], d[i], sigma, s, directions, start, end)
                edge = (inside.sure_start[i] - start) + (inside.end[i] - inside.sure_end[i])
                error[i] += edge if edge < np.inf else 0.0
        scale = np.atleast_1d(np.multiply(medium.sigma_s, light.radiance))
        error = np.where(scale > 0, scale * error + TINY, 0.0)
        value = np.where(scale > 0, scale * value, 0.0)
    return value, error, METHOD, SOURCE


def _along(
    shape: Shape,
    origin: np.ndarray,
    d: np.ndarray,
    sigma: np.ndarray,
    s: np.ndarray,
    directions: np.ndarray,
    start: float,
    end: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral over one ray for each channel, and its error."""
    phi = 2 * np.pi * np.arange(AZIMUTHS) / AZIMUTHS
    side = np.cross(d, np.eye(3)[np.argmin(np.abs(d))])
    side /= np.linalg.norm(side)
    up = np.cross(d, side)
    sine = 1 / np.cosh(s)
    # The light travels along w, at the forward cosine mu from -d; it is followed back along -w.
    back = np.tanh(s)[:, None, None] * d + sine[:, None, None] * (
        np.cos(phi)[:, None] * side + np.sin(phi)[:, None] * up
    )
    results = []
    for panels in (PANELS, PANELS // 2):
        edges = np.arange(panels) / panels
        y = (edges[:, None] + NODES / panels).ravel()
        weights = np.tile(WEIGHTS / panels, panels) * 6 * y * (1 - y) * (end - start)
        t = start + (end - start) * (y * y * (3 - 2 * y))
        inner = np.array([_received(shape, origin + x * d, back, sigma, directions) for x in t])
        results.append(np.einsum("t,tc,tkc->kc", weights, np.exp(-sigma * (t - start)[:, None]), inner))
    fine, coarse = results
    value, half_s, half_phi, noise = fine
    error = np.abs(value - half_s) + np.abs(value - half_phi) + 2 * np.abs(value - coarse[0]) + noise
    return value, error + 64 * EPS * value


def _received(shape: Shape, x: np.ndarray, back: np.ndarray, sigma: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Return int f_p exp(-sigma d) dw at a point: by the full rule, two half as fine, and the error of f_p, (4, channels)."""
    way = np.maximum(through(shape, x, back)[1], 0.0)
    weight, noise = directions
    survive = np.exp(-sigma * way[..., None])  # (s, phi, channels)
    survive = np.where(np.isnan(survive), 0.0, survive)
    around = 2 * np.pi * survive.mean(axis=1)
    every_other = 2 * np.pi * survive[:, ::2].mean(axis=1)
    return np.stack([weight @ around, 2 * weight[::2] @ around[::2], weight @ every_other, noise @ around])
