"""Optical thickness of OpenGL's three fogs, whose transmittance is the fog factor."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.double_double import UNIT
from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY
from fogproof.analytic.geometry.rays import Rays, Thickness
from fogproof.errors import UnsupportedError
from fogproof.scene import OpenGLFog

SOURCE = "Segal & Akeley 2010, The OpenGL Graphics System, version 4.0 compatibility profile, section 3.11"


def fog_thickness(medium: OpenGLFog, rays: Rays) -> Thickness:
    """Return tau of a distance s from the eye: density s, (density s)^2, or log((end - start)/(end - s)).

    Error: 2^-100 relative for "exp" and "exp2", 8 EPS for "linear".
    """
    if not (rays.origin == medium.eye).all():
        raise UnsupportedError(f"OpenGL fog is seen from its eye {medium.eye.tolist()}: start the rays there", "ray")
    if medium.mode == "linear":
        return _linear(medium.start, medium.end, rays.length)
    s = dd.pair(rays.length if medium.density > 0 else np.zeros_like(rays.length))
    tau = dd.times(dd.pair(medium.density), s)
    if medium.mode == "exp2":
        tau = dd.times(tau, tau)
    with np.errstate(under="ignore"):
        error = np.where(np.isinf(tau[0]), 0.0, UNIT * tau[0] + 4 * TINY)
    return Thickness(*tau, error, f"fog factor of mode {medium.mode}", SOURCE)


def _linear(start: float, end: float, s: np.ndarray) -> Thickness:
    s = np.clip(s, start, end)
    with np.errstate(divide="ignore", over="ignore", under="ignore"):
        value = np.log1p((s - start) / (end - s))
    error = np.where(np.isinf(value), 0.0, (ELEMENTARY + 3 * EPS) * value + 2 * TINY)
    return Thickness(value, np.zeros_like(value), error, "fog factor of mode linear", SOURCE)
