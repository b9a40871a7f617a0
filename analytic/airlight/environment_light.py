"""Airlight of a constant environment in a homogeneous medium that fills a half space, a slab or a ball.

    L = sigma_s L_env int exp(-sigma_t (t - t_enter)) int f_p(mu) exp(-sigma_t d(t, w)) dw dt        [W/(m^2 sr)]

d is the way from the point at t back along the light's direction to the boundary. Directions are taken around the ray, by
mu = tanh(s), in which Henyey-Greenstein and the like are analytic for every g, and the azimuth.

Between planes d is linear in t and the integral over t is in closed form; in a ball it is done last, around each point the
centre takes the place of the normal. What is left has no singularity but at the horizon and the ends of the ray, where double
exponential rules begin and end. The error is estimated from rules half as fine.
Source of the rules: Takahasi & Mori 1974, Double exponential formulas for numerical integration.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial

import numpy as np

from fogproof.analytic.airlight.phase import airlight_phase
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.geometry.convex_shapes import chord, faces
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.analytic.phase.functions import phase_pdf
from fogproof.errors import UnsupportedError
from fogproof.scene import AnyMedium, Medium
from fogproof.scene.lights import Environment
from fogproof.scene.occluders import Occluder
from fogproof.scene.phase import Isotropic, PhaseFunction
from fogproof.scene.shapes import Ball, HalfSpace, Shape, Slab, Unbounded

METHOD = "double exponential rules over directions and along the ray"
SOURCE = "Beer's law along both ways, integrated; Takahasi & Mori 1974"

REACH = 20.0
"""Largest |s|: 1 - |tanh s| < 1e-17 beyond."""

Rule = tuple[np.ndarray, np.ndarray]


def environment_light(
    medium: AnyMedium, ray: FlatRays, light: Environment, shape: Shape, occluders: Sequence[Occluder]
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
    if not isinstance(shape, HalfSpace | Slab | Ball):
        raise UnsupportedError(f"an environment around a {type(shape).__name__}; use HalfSpace, Slab or Ball", "shape")
    inside = chord(shape, ray)
    origin, d = ray.origin, ray.direction
    with np.errstate(all="ignore"):
        for i in range(len(value)):
            start, end = inside.start[i], inside.end[i]
            if end > start:
                given = medium.phase, origin[i], d[i], sigma, start, end
                rule = (
                    partial(_in_ball, shape, *given)
                    if isinstance(shape, Ball)
                    else partial(_between_planes, shape, *given)
                )
                coarse, (value[i], noise) = rule(1)[0], rule(2)
                error[i] = np.abs(value[i] - coarse) + noise + 256 * EPS * value[i]
                unsure = (inside.sure_start[i] - start) + (end - inside.sure_end[i] if end < np.inf else 0.0)
                error[i] += unsure
        scale = np.atleast_1d(np.multiply(medium.sigma_s, light.radiance))
        error = np.where(scale > 0, scale * error + TINY, 0.0)
        value = np.where(scale > 0, scale * value, 0.0)
    return value, error, METHOD, SOURCE


@cache
def _double_exponential(panels: int) -> Rule:
    """Return distances from the nearer end, signed (from 0 if positive, from 1 if negative), and weights on [0, 1]."""
    step = 3.2 / panels
    x = step * np.arange(-panels, panels + 1)
    q = np.pi / 2 * np.sinh(x)
    near = 1 / (1 + np.exp(2 * np.abs(q)))  # distance from the nearer end
    weights = step * np.pi / 2 * np.cosh(x) * 2 * near * (1 - near)
    return np.where(q < 0, near, -near), weights / weights.sum()


def _on(low: np.ndarray, high: np.ndarray, fine: int, panels: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and weights of the double exponential rule on each interval, (..., nodes)."""
    x, weights = _double_exponential(panels * fine)
    low, high = low[..., None], high[..., None]
    return np.where(x > 0, low + (high - low) * x, high + (high - low) * x), weights * (high - low)


def _over_directions(
    phase: PhaseFunction, mu0: float, G: Callable[[np.ndarray], np.ndarray], fine: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return int f_p(b . d) G(b . n) db over directions b back to the light, per channel, and what f_p's error is of it.

    mu0  d . n, for the direction d of the ray and the axis n about which G is symmetric; G (..., channels) may have a
         singularity at the horizon b . n = 0
    """
    if isinstance(phase, Isotropic):
        cosine, weights = (x.ravel() for x in _on(np.array([-1.0, 0.0]), np.array([0.0, 1.0]), fine))
        total = 0.5 * weights @ G(cosine)
        return total, EPS * total
    sine0 = np.sqrt((1 - mu0) * (1 + mu0))
    tangent = np.arctanh(min(sine0, 1 - EPS))  # beyond that |s| all azimuths are on one side of the horizon
    kinks = np.arctanh(np.clip(airlight_phase(phase).kinks, -1 + EPS, 1 - EPS))
    breaks = np.unique(np.clip([-REACH, *range(-6, 7, 3), -tangent, tangent, REACH, *kinks], -REACH, REACH))
    s, s_weights = (x.ravel() for x in _on(breaks[:-1], breaks[1:], fine))
    f = phase_pdf(phase, np.tanh(s))
    s_weights = s_weights / np.cosh(s) ** 2
    C, D = np.tanh(s) * mu0, sine0 / np.cosh(s)
    horizon = np.arccos(np.clip(-C / D, -1, 1)) if sine0 > 0 else np.where(C > 0, np.pi, 0.0)
    total = 0.0
    for low, high in ((np.zeros_like(horizon), horizon), (horizon, np.full_like(horizon, np.pi))):
        phi, weights = _on(low, high, fine)
        total = total + 2 * np.einsum("sp,spc->sc", weights, G(C[:, None] + D[:, None] * np.cos(phi)))
    return (s_weights * f.value) @ total, (s_weights * f.error) @ total


def _between_planes(
    shape: HalfSpace | Slab,
    phase: PhaseFunction,
    origin: np.ndarray,
    d: np.ndarray,
    sigma: np.ndarray,
    start: float,
    end: float,
    fine: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral over directions of the integral along the ray, per channel, and what f_p's error is of it."""
    normals, offsets = faces(shape)

    def along(cosine: np.ndarray) -> np.ndarray:
        return _along(normals, offsets, origin, d, sigma, start, end, cosine)

    return _over_directions(phase, float(np.clip(normals[0] @ d, -1, 1)), along, fine)


def _along(
    normals: np.ndarray,
    offsets: np.ndarray,
    origin: np.ndarray,
    d: np.ndarray,
    sigma: np.ndarray,
    start: float,
    end: float,
    cosine: np.ndarray,
) -> np.ndarray:
    """Return int_start^end exp(-sigma (t - start + d(t))) dt for light from directions at `cosine` to the first normal."""
    result = np.zeros((*cosine.shape, len(sigma)))
    for sign, normal, offset in zip((1, -1), normals, offsets, strict=False):
        facing = sign * cosine
        there = facing > 0
        steep = np.where(there, facing, 1.0)
        depth, growth = max(offset - origin @ normal - start * (d @ normal), 0.0), -(d @ normal)
        first = depth / steep
        slope = 1 + growth / steep
        length = end - start
        last = first + slope * length
        least = np.where(slope >= 0, first, np.maximum(last, 0.0))
        x = sigma * np.abs(slope * length)[..., None]
        reach = np.where(x > 0, -np.expm1(-x) / x, 1.0) * length
        reach = np.where(np.isinf(x), 1 / (sigma * np.abs(slope)[..., None]), reach)
        result += np.where(there[..., None], np.exp(-sigma * least[..., None]) * reach, 0.0)
    return result


def _in_ball(
    shape: Ball,
    phase: PhaseFunction,
    origin: np.ndarray,
    d: np.ndarray,
    sigma: np.ndarray,
    start: float,
    end: float,
    fine: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral along the ray of the integral over directions, per channel, and what f_p's error is of it."""
    value, spread = np.zeros((2, len(sigma)))
    t, weights = _on(np.array(start), np.array(end), fine)
    for one, weight in zip(t, weights, strict=True):
        q = origin - np.array(shape.center) + one * d
        distance = float(np.linalg.norm(q))
        mu0 = float(np.clip(q @ d / distance, -1, 1)) if distance > 0 else 1.0
        room = max((shape.radius - distance) * (shape.radius + distance), 0.0)

        def survival(cosine: np.ndarray, distance: float = distance, room: float = room) -> np.ndarray:
            """exp(-sigma d), d = sqrt(c^2 + R^2 - r^2) - c with c = r cos, without cancellation."""
            c = distance * cosine
            root = np.sqrt(c * c + room)
            way = np.where(c > 0, room / (root + c), root - c)
            return np.exp(-sigma * way[..., None])

        received, noise = _over_directions(phase, mu0, survival, fine)
        lit = weight * np.exp(-sigma * (one - start))
        value += lit * received
        spread += lit * noise
    return value, spread
