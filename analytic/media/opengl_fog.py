"""OpenGL's three fogs, whose transmittance is the fog factor."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.double_double import UNIT
from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY
from fogproof.analytic.geometry.rays import Thickness, rays_with_channels
from fogproof.analytic.media.adaptive import thickness_by_quadrature
from fogproof.analytic.media.breakpoints import Breaks
from fogproof.analytic.media.coefficients import Coefficients, Points, by_albedo
from fogproof.analytic.media.squared_extinction import Integral, by_panels
from fogproof.analytic.proven.balls import flint, rational
from fogproof.analytic.proven.pieces import Piece, constant
from fogproof.errors import UnsupportedError
from fogproof.scene import OpenGLFog, Ray

SOURCE = "Segal & Akeley 2010, The OpenGL Graphics System, version 4.0 compatibility profile, section 3.11"


def coefficients(medium: OpenGLFog, at: Points) -> Coefficients:
    """Return the extinction at a distance from the eye and what belongs to it."""
    return by_albedo(
        _sigma(medium, np.sqrt(np.sum((at.place - medium.eye) ** 2, axis=-1))), medium.albedo, medium.emission
    )


def _sigma(medium: OpenGLFog, r: np.ndarray) -> np.ndarray:
    if medium.mode == "exp":
        return np.full_like(r, medium.density)
    if medium.mode == "exp2":
        return 2 * medium.density**2 * r
    with np.errstate(divide="ignore"):
        return np.where(r < medium.start, 0.0, np.where(r < medium.end, 1 / (medium.end - r), np.inf))


def breakpoints(medium: OpenGLFog, origin: np.ndarray, direction: np.ndarray, length: np.ndarray) -> Breaks:
    """Return where linear fog begins, and where nothing is left."""
    offset = origin - medium.eye
    near = -np.sum(offset * direction, axis=-1)
    p2 = np.sum((offset + near[:, None] * direction) ** 2, axis=-1)
    halves = [np.sqrt(np.maximum(r * r - p2, 0.0)) for r in (medium.start, medium.end)]
    found = np.stack([near, near - halves[0], near + halves[0], near + halves[1]], axis=-1)
    leave = np.minimum(length, np.where(halves[1] > 0, near + halves[1], length)) if medium.mode == "linear" else length
    return Breaks(np.zeros_like(length), np.maximum(leave, 0.0), [found])


def thickness(medium: OpenGLFog, ray: Ray, channels: int | None) -> Thickness:
    """Return tau of a distance s from the eye: density s, (density s)^2, or log((end - start)/(end - s)).

    Rays that start elsewhere cross the same medium, by quadrature; what enters the end of linear fog does not come out.
    Error: 2^-100 relative for "exp" and "exp2", 8 EPS for "linear"; by quadrature, estimated.
    """
    if medium.mode != "exp" and not (ray.origin == medium.eye).all():
        return _off_the_eye(medium, ray, channels)
    rays = rays_with_channels(ray, channels)
    if medium.mode == "linear":
        return _linear(medium.start, medium.end, rays.length)
    s = dd.pair(rays.length if medium.density > 0 else np.zeros_like(rays.length))
    tau = dd.times(dd.pair(medium.density), s)
    if medium.mode == "exp2":
        tau = dd.times(tau, tau)
    with np.errstate(under="ignore"):
        error = np.where(np.isinf(tau[0]), 0.0, UNIT * tau[0] + 4 * TINY)
    return Thickness(*tau, error, f"fog factor of mode {medium.mode}", SOURCE)


def _off_the_eye(medium: OpenGLFog, ray: Ray, channels: int | None) -> Thickness:
    """Return tau along rays through "exp2" or "linear" fog from anywhere."""
    origin, direction, length = ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3), ray.length.reshape(-1)
    if medium.mode == "linear":
        reach = np.where(np.isfinite(length), length, 2 * medium.end + 2 * np.abs(origin - medium.eye).sum(axis=-1))
        ends = np.stack([origin, origin + reach[:, None] * direction]) - medium.eye
        gone = (np.sqrt(np.sum(ends**2, axis=-1)) >= medium.end).any(axis=0)  # the ball is convex: else all lies inside
    else:
        gone = np.isinf(length) & (medium.density > 0)
    shape = ray.shape if channels is None else (*ray.shape, channels)
    value, error = np.zeros((2, len(length), channels or 1))
    value[gone] = np.inf
    if not gone.all():
        inside = thickness_by_quadrature(medium, Ray(origin[~gone], direction[~gone], length[~gone]), channels)
        value[~gone], error[~gone] = (x.reshape(-1, channels or 1) for x in (inside.value, inside.error))
    value, error = value.reshape(shape), error.reshape(shape)
    return Thickness(value, np.zeros(shape), error, "adaptive Gauss-Legendre 16", SOURCE)


def _linear(start: float, end: float, s: np.ndarray) -> Thickness:
    s = np.clip(s, start, end)
    with np.errstate(divide="ignore", over="ignore", under="ignore"):
        value = np.log1p((s - start) / (end - s))
    error = np.where(np.isinf(value), 0.0, (ELEMENTARY + 3 * EPS) * value + 2 * TINY)
    return Thickness(value, np.zeros_like(value), error, "fog factor of mode linear", SOURCE)


def squared_extinction(medium: OpenGLFog, ray: Ray, channels: int | None) -> Integral:
    """Return the integral of sigma_t^2; linear fog has 1/(end - s) - 1/(end - start), inf where the ray reaches its end."""
    if medium.mode != "linear":
        return by_panels(medium, ray, channels)
    span = medium.end - medium.start
    inside = np.clip(rays_with_channels(ray, channels).length - medium.start, 0.0, span)
    shape = ray.shape if channels is None else (*ray.shape, channels)
    with np.errstate(divide="ignore", invalid="ignore"):
        value = np.where(inside > 0, inside / (span * (span - inside)), 0.0)
        slack = EPS * medium.end * (1 / span + 1 / (span - inside)) + 4 * EPS
        error = np.where(np.isfinite(value), 3 * slack * value + TINY, 0.0)
    return Integral(np.broadcast_to(value, shape), np.broadcast_to(error, shape), "closed form")


def pieces(fog: OpenGLFog, origin: np.ndarray, direction: np.ndarray, s: Any) -> list[Piece]:
    """Return vacuum and fog from the eye on."""
    if not (np.asarray(origin) == fog.eye).all():
        raise UnsupportedError(f"OpenGL fog is seen from its eye {fog.eye.tolist()}: start the rays there", "ray")
    source = rational(fog.albedo), rational(fog.emission)
    arb, density = flint().arb, rational(fog.density)
    if fog.mode == "exp" or (fog.mode == "exp2" and not density):
        return [constant(density, s, *source)]
    if fog.mode == "exp2":
        tau = arb.pos_inf() if s is None else arb((density * s) ** 2)
        return [Piece(s, tau, *source, survived=lambda z: (-((density * z) ** 2)).exp())]
    start, end = rational(fog.start), rational(fog.end)
    if s is not None and s <= start:
        return [constant(flint().fmpq(0), s, *source)]
    reach = end - start if s is None else min(s, end) - start
    tau = arb.pos_inf() if reach == end - start else -(1 - arb(reach) / (end - start)).log()
    foggy = Piece(reach, tau, *source, survived=lambda z: 1 - z / (end - start))
    return [constant(flint().fmpq(0), start, *source), foggy]
