"""Linearly graded extinction.

Along a ray sigma_t(t) = max(0, a + b t) with a = sigma_0 + gradient . origin and b = gradient . direction. Both are dot
products that cancel easily; as pairs they do not lose anything.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.double_double import UNIT, Pair
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.geometry.rays import Rays, Thickness, rays_with_channels
from fogproof.analytic.media.breakpoints import Breaks
from fogproof.analytic.media.coefficients import Coefficients, Points, by_albedo
from fogproof.analytic.media.squared_extinction import Integral, by_panels
from fogproof.analytic.proven.balls import flint, rational, vector
from fogproof.analytic.proven.pieces import Piece, constant, dot
from fogproof.scene import LinearMedium, Ray

METHOD = "area under a clamped line"
SOURCE = "elementary: tau = s (sigma(0) + sigma(s))/2, or a triangle where the medium ends"


def coefficients(medium: LinearMedium, at: Points) -> Coefficients:
    """Return max(0, sigma_0 + gradient . x) and what belongs to it; vacuum does not glow."""
    sigma_t = np.maximum(0.0, medium.sigma_0 + np.sum(medium.gradient * at.place, axis=-1))
    return by_albedo(sigma_t, medium.albedo, np.where(sigma_t > 0, medium.emission, 0.0))


def breakpoints(medium: LinearMedium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray) -> Breaks:
    """Return where the line crosses 0."""
    gradient = np.atleast_2d(medium.gradient)
    zero = -(np.atleast_1d(medium.sigma_0) + origin @ gradient.T) / (direction @ gradient.T)
    return Breaks(np.zeros_like(length), length, [np.where(np.isnan(zero), 0.0, zero)])


def thickness(medium: LinearMedium, ray: Ray, channels: int | None) -> Thickness:
    """Return tau along rays; on an infinite ray inf, or the finite area up to where the medium ends.

    Error: about 2^-98 (1 + condition of the two dot products) relative.
    """
    rays = rays_with_channels(ray, channels)
    a, b, a_error, b_error = _line(medium, rays)
    s = np.broadcast_to(rays.length, a[0].shape)
    finite = np.where(np.isfinite(s), s, 0.0)
    zero = dd.pair(np.zeros_like(s))
    at_start = dd.where(dd.less(a, zero), zero, a)
    at_end = dd.add(a, dd.times(b, dd.pair(finite)))
    at_end = dd.where(dd.less(at_end, zero) | (np.isinf(s) & (b[0] < 0)), zero, at_end)

    whole = (at_start[0] > 0) & (at_end[0] > 0)
    top = dd.where(at_start[0] > 0, at_start, at_end)
    slope = dd.where(b[0] < 0, dd.negative(b), b)
    slope = dd.where(slope[0] > 0, slope, dd.pair(np.ones_like(s)))
    reach = dd.where(whole | (b[0] == 0), dd.pair(finite), dd.divide(top, slope))
    height = dd.add(at_start, at_end)
    tau = dd.times(reach, (height[0] / 2, height[1] / 2))
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        error = UNIT * tau[0] + reach[0] * (a_error + np.maximum(finite, reach[0]) * b_error) + 2 * TINY
        error = np.where(np.isinf(tau[0]), np.inf, error)

    endless = np.isinf(s) & ((b[0] > 0) | ((b[0] == 0) & (a[0] > 0)))
    unsure = np.isinf(s) & (np.abs(b[0]) <= b_error) & (b[0] != 0)
    value, low = dd.where(endless, dd.pair(np.full_like(s, np.inf)), tau)
    return Thickness(value, low, np.where(unsure, np.inf, np.where(endless, 0.0, error)), METHOD, SOURCE)


def free_path(medium: LinearMedium, rays: Rays, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the distance at which the thickness reaches tau, inf if it never does, and its error bound.

        t = 2 tau / (a + sqrt(a^2 + 2 b tau)), or -a/b + sqrt(2 tau / b) where the medium begins only at -a/b

    One formula for b > 0, b < 0 and b = 0: nothing cancels but the root, whose argument is a pair.
    """
    a, b, a_error, b_error = _line(medium, rays)
    tau = np.broadcast_to(tau, np.broadcast_shapes(a[0].shape, tau.shape))
    zero = dd.pair(np.zeros_like(tau))
    inside = ~dd.less(a, zero)
    start = dd.where(inside, a, zero)
    # Everything in units of 2^exponent [1/m], so that no square leaves the range of numbers.
    exponent = np.frexp(np.maximum(start[0], np.sqrt(np.abs(b[0])) * np.sqrt(2 * tau)))[1]
    start = dd.each(lambda x: np.ldexp(x, -exponent), start)
    twice = dd.times(dd.each(lambda x: np.ldexp(x, -2 * exponent), b), dd.pair(2 * tau))
    a_error, b_error = np.ldexp(a_error, -exponent), np.ldexp(b_error, -2 * exponent)
    square = dd.add(dd.times(start, start), twice)
    escapes = (square[0] < 0) | ((square[0] == 0) & (b[0] == 0)) | (~inside & (b[0] <= 0))
    root = dd.square_root(dd.where(escapes, dd.pair(np.ones_like(tau)), square))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        distance = dd.divide(dd.pair(np.ldexp(2 * tau, -exponent)), dd.add(start, root))
        offset = dd.where(inside, zero, dd.divide(dd.negative(a), b))
        t = dd.add(distance, offset)

        # The root's argument is off by `slack`; near its zero a root is off by the root of that.
        slack = UNIT * (start[0] ** 2 + np.abs(twice[0])) + 2 * start[0] * a_error + 2 * tau * b_error
        root_error = np.minimum(np.sqrt(slack), slack / root[0])
        error = distance[0] * (UNIT + (root_error + a_error) / (start[0] + root[0]))
        unscaled = np.ldexp(a_error, exponent), np.ldexp(b_error, 2 * exponent)
        error = error + np.where(inside, 0.0, (unscaled[0] + offset[0] * (unscaled[1] + UNIT * b[0])) / b[0])
        unsure = inside & (np.abs(square[0]) <= slack) & (tau > 0) & (slack > 0)
    none = tau == 0
    value = np.where(none, 0.0, np.where(escapes, np.inf, t[0]))
    error = np.where(none | escapes, 0.0, error + EPS * t[0] + TINY)
    return value, np.where(unsure & ~none, np.inf, error)


def _line(medium: LinearMedium, rays: Rays) -> tuple[Pair, Pair, np.ndarray, np.ndarray]:
    """Return a and b of the line along each ray, and bounds of their errors."""
    a = dd.add(dd.pair(medium.sigma_0), dd.dot(medium.gradient, rays.origin))
    b = dd.dot(medium.gradient, rays.direction)
    shape = np.broadcast_shapes(a[0].shape, b[0].shape)
    a, b = (dd.each(lambda x: np.broadcast_to(x, shape), line) for line in (a, b))
    a_error = UNIT * np.abs(medium.sigma_0) + dd.dot_error(medium.gradient, rays.origin)
    return a, b, a_error, dd.dot_error(medium.gradient, rays.direction)


def squared_extinction(medium: LinearMedium, ray: Ray, channels: int | None) -> Integral:
    """Return the integral of sigma_t^2, a quadratic between breaks."""
    return by_panels(medium, ray, channels)


def pieces(medium: LinearMedium, origin: np.ndarray, direction: np.ndarray, length: Any) -> list[Piece]:
    """Return the one piece of the ray where the line is above 0."""
    gradient, w = vector(medium.gradient), vector(direction)
    a, b = rational(medium.sigma_0) + dot(gradient, vector(origin)), dot(gradient, w)
    return _above_zero(a, b, length, (rational(medium.albedo), rational(medium.emission)))


def _above_zero(a: Any, b: Any, s: Any, source: tuple[Any, Any]) -> list[Piece]:
    arb, zero = flint().arb, flint().fmpq(0)
    start, end = zero, s
    if b == 0:
        return [constant(a, s, *source)] if a > 0 else []
    if b > 0:
        start = max(start, -a / b)
    else:
        end = -a / b if end is None else min(end, -a / b)
    if end is None:
        return [Piece(None, arb.pos_inf(), *source, survived=lambda z: (-(a * z + z * z * b / 2)).exp())]
    if end <= start:
        return []
    height, length = a + b * start, end - start
    tau = height * length + b * length * length / 2
    return [Piece(length, arb(tau), *source, survived=lambda z: (-(z * height + z * z * b / 2)).exp())]
