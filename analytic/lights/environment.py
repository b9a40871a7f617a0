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
from typing import Any

import numpy as np

from fogproof.analytic.airlight.incident import Incident
from fogproof.analytic.airlight.phase import airlight_phase
from fogproof.analytic.airlight.result import Result
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.geometry.convex_shapes import chord
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.analytic.media.coefficients import is_uniform
from fogproof.analytic.phase.functions import has_poles, phase_values
from fogproof.scene import AnyMedium
from fogproof.scene.kinds import given
from fogproof.scene.lights import Environment
from fogproof.scene.occluders import Occluder
from fogproof.scene.phase import Isotropic, PhaseFunction
from fogproof.scene.shapes import Shape

same_all_around = True

METHOD = "double exponential rules over directions and along the ray"
SOURCE = "Beer's law along both ways, integrated; Takahasi & Mori 1974"

REACH = 20.0
"""Largest |s|: 1 - |tanh s| < 1e-17 beyond."""

FAR = 345.0
"""The same where the phase function may be infinite straight ahead."""

Rule = tuple[np.ndarray, np.ndarray]
Answer = tuple[np.ndarray, np.ndarray]
"""Integral and what the error of f_p is of it, (channels,) each."""


def single_scattering(
    medium: AnyMedium, ray: FlatRays, light: Environment, shape: Shape, occluders: Sequence[Occluder], **_how: Any
) -> Result | None:
    """Return the radiance (n, channels) along the flattened rays and its estimated error; None for other media and shapes."""
    along = given(shape, "fogproof.analytic.shapes", "environment")
    if along is None or occluders or not is_uniform(medium):
        return None
    sigma = np.atleast_1d(medium.sigma_t)
    value, error = np.zeros((2, ray.length.size, len(sigma)))
    inside = chord(shape, ray)
    origin, d = ray.origin, ray.direction
    with np.errstate(all="ignore"):
        for i in range(len(value)):
            start, end = inside.start[i], inside.end[i]
            if end > start:
                rule = partial(along, shape, medium.phase, origin[i], d[i], sigma, start, end)
                coarse, (value[i], noise) = rule(1)[0], rule(2)
                error[i] = np.abs(value[i] - coarse) + noise + 256 * EPS * value[i]
                error[i] += inside.sure_start[i] - start
                if end < np.inf:
                    error[i] += (end - inside.sure_end[i]) * np.exp(-sigma * (inside.sure_end[i] - start))
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


def on_interval(low: np.ndarray, high: np.ndarray, fine: int, panels: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and weights of the double exponential rule on each interval, (..., nodes)."""
    x, weights = _double_exponential(panels * fine)
    low, high = low[..., None], high[..., None]
    return np.where(x > 0, low + (high - low) * x, high + (high - low) * x), weights * (high - low)


def over_directions(
    phase: PhaseFunction, mu0: float, G: Callable[[np.ndarray], np.ndarray], fine: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return int f_p(b . d) G(b . n) db over directions b back to the light, per channel, and what f_p's error is of it.

    mu0  d . n, for the direction d of the ray and the axis n about which G is symmetric; G (..., channels) may have a
         singularity at the horizon b . n = 0
    """
    if isinstance(phase, Isotropic):
        cosine, weights = (x.ravel() for x in on_interval(np.array([-1.0, 0.0]), np.array([0.0, 1.0]), fine))
        total = 0.5 * weights @ G(cosine)
        return total, EPS * total
    sine0 = np.sqrt((1 - mu0) * (1 + mu0))
    tangent = np.arctanh(min(sine0, 1 - EPS))  # beyond that |s| all azimuths are on one side of the horizon
    kinks = np.arctanh(np.clip(airlight_phase(phase).kinks, -1 + EPS, 1 - EPS))
    outermost = [FAR, 160.0, 70.0, 35.0] if has_poles(phase) else [REACH]
    reach = outermost[0]
    places = [*range(-6, 7, 3), -tangent, tangent, *kinks, *outermost, *(-x for x in outermost)]
    breaks = np.unique(np.clip(places, -reach, reach))
    s, s_weights = (x.ravel() for x in on_interval(breaks[:-1], breaks[1:], fine))
    value, error = phase_values(phase, np.tanh(s), 1 / (1 + np.exp(2 * s)), 1 / (1 + np.exp(-2 * s)))
    s_weights = s_weights / np.cosh(s) ** 2
    C, D = np.tanh(s) * mu0, sine0 / np.cosh(s)
    horizon = np.arccos(np.clip(-C / D, -1, 1)) if sine0 > 0 else np.where(C > 0, np.pi, 0.0)
    total = 0.0
    for low, high in ((np.zeros_like(horizon), horizon), (horizon, np.full_like(horizon, np.pi))):
        phi, weights = on_interval(low, high, fine)
        total = total + 2 * np.einsum("sp,spc->sc", weights, G(C[:, None] + D[:, None] * np.cos(phi)))
    return (s_weights * value) @ total, (s_weights * error) @ total


def between_planes(
    normals: np.ndarray,
    offsets: np.ndarray,
    phase: PhaseFunction,
    origin: np.ndarray,
    d: np.ndarray,
    sigma: np.ndarray,
    start: float,
    end: float,
    fine: int,
) -> Answer:
    """Return the integral over directions of the integral along the ray, per channel, and what f_p's error is of it.

    normals, offsets  of one plane, or of two that are parallel
    """

    def along(cosine: np.ndarray) -> np.ndarray:
        return _along(normals, offsets, origin, d, sigma, start, end, cosine)

    return over_directions(phase, float(np.clip(normals[0] @ d, -1, 1)), along, fine)


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


def incident(_light: Environment, x: np.ndarray, nodes: int) -> Incident:
    """Return a rule over all directions: Gauss-Legendre in the cosine to z and in the azimuth, octant by octant."""
    y, weights = np.polynomial.legendre.leggauss(nodes)
    y, weights = 0.5 * (y + 1), 0.5 * weights
    cosine, cosine_weight = np.concatenate([-y, y]), np.concatenate([weights, weights])
    angle = (np.arange(4)[:, None] + y).ravel() * (np.pi / 2)
    angle_weight = np.tile(weights, 4) * (np.pi / 2)
    sine = np.sqrt((1 - cosine) * (1 + cosine))
    z = np.broadcast_to(cosine[:, None], (len(cosine), len(angle)))
    w = np.stack([np.outer(sine, np.cos(angle)), np.outer(sine, np.sin(angle)), z], axis=-1).reshape(1, -1, 3)
    weight = np.outer(cosine_weight, angle_weight).reshape(1, -1)
    shape = (len(x), weight.shape[1])
    return Incident(np.broadcast_to(w, (*shape, 3)), np.full(shape, np.inf), np.broadcast_to(weight, shape))
