"""Exponentially graded extinction.

Along a ray sigma_t(t) = sigma_0 e^{e + k t} with e = rate . origin and k = rate . direction.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.double_double import Pair
from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY
from fogproof.analytic.geometry.rays import Rays, Thickness, rays_with_channels
from fogproof.analytic.media.coefficients import Coefficients, Points, by_albedo
from fogproof.analytic.proven.balls import flint, rational, vector
from fogproof.analytic.proven.pieces import Piece, constant, dot
from fogproof.scene import ExponentialMedium, Ray

METHOD = "integral of an exponential"
SOURCE = "elementary: tau = sigma_max s phi1(|k| s), phi1(x) = (1 - e^-x)/x, sigma_max at the denser end"


def coefficients(medium: ExponentialMedium, at: Points) -> Coefficients:
    """Return sigma_0 exp(rate . x) and what belongs to it."""
    sigma_t = medium.sigma_0 * np.exp(np.sum(medium.rate * at.place, axis=-1))
    return by_albedo(sigma_t, medium.albedo, medium.emission)


def thickness(medium: ExponentialMedium, ray: Ray, channels: int | None) -> Thickness:
    """Return tau along rays; on an infinite ray sigma/|k| where the extinction falls, else inf.

    The denser end is the reference, so that no factor overflows before the result does.
    A thickness beyond the largest float64 is inf. Error: 32 EPS relative, plus 2^-100 of the terms of the exponent.
    """
    rays = rays_with_channels(ray, channels)
    e, k, e_error, k_error = _exponent(medium, rays)
    s = np.broadcast_to(rays.length, e[0].shape)
    finite = np.where(np.isfinite(s), s, 0.0)
    climb = dd.times(k, dd.pair(finite))
    top = dd.where(climb[0] > 0, dd.add(e, climb), e)
    with np.errstate(over="ignore", under="ignore", invalid="ignore", divide="ignore"):
        x = np.where(np.isfinite(s), np.abs(climb[0]), np.inf)
        reach = np.where(
            np.isfinite(s), s * np.where(x > 0, -np.expm1(-x) / np.where(x > 0, x, 1), 1.0), 1 / np.abs(k[0])
        )
        there = np.multiply(medium.sigma_0, np.ones_like(s)) > 0
        value = np.where(there, _sigma(medium.sigma_0, top, reach), 0.0)
        relative = 5 * ELEMENTARY + 12 * EPS + e_error + np.maximum(finite, np.minimum(reach, 1e300)) * k_error
        error = relative * value + 4 * TINY * (1 + reach)
        error = np.where(np.isinf(value), 0.0, error)  # more than any float64, for sure
    empty = np.multiply(medium.sigma_0, np.ones_like(s)) == 0
    endless = np.isinf(s) & (k[0] >= 0) & ~empty
    unsure = np.isinf(s) & (np.abs(k[0]) <= k_error) & (k[0] != 0) & ~empty
    value = np.where(endless, np.inf, value)
    error = np.where(endless | empty, 0.0, error)
    return Thickness(value, np.zeros_like(value), np.where(unsure, np.inf, error), METHOD, SOURCE)


def _sigma(sigma_0: Any, power: Pair, reach: np.ndarray) -> np.ndarray:
    """Return sigma_0 exp(power) reach where it is a float64, even if exp(power) is none: then by its fourth root."""
    root = np.exp(power[0] / 4) * (1 + power[1] / 4)
    extreme = sigma_0 * root * root * reach * root * root
    plain = np.exp(power[0]) * (1 + power[1]) * sigma_0 * reach
    return np.where(np.abs(power[0]) > 700, extreme, plain)


def free_path(medium: ExponentialMedium, rays: Rays, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the distance at which the thickness reaches tau, inf if it never does, and its error bound.

        t = (tau/sigma) Lg(k tau/sigma), Lg(x) = log1p(x)/x, sigma = sigma_0 e^e; x <= -1 escapes

    Where the ray starts so far out that sigma underflows, log1p(x) = log x + 1/x is taken from the logarithms.
    """
    e, k, e_error, _ = _exponent(medium, rays)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore", under="ignore"):
        sigma = np.exp(e[0]) * (1 + e[1]) * medium.sigma_0
        q = tau / sigma
        x = k[0] * q
        t = np.where(x == 0, q, q * (np.log1p(x) / np.where(x == 0, 1, x)))
        relative = ELEMENTARY + 4 * EPS + e_error + TINY / sigma
        error = (ELEMENTARY + 3 * EPS) * t + q * relative / (1 + x - np.abs(x) * relative)

        logs = [np.log(k[0]), np.log(tau), -np.log(medium.sigma_0), -e[0]]
        log_x = logs[0] + logs[1] + logs[2] + logs[3]
        far = (k[0] > 0) & (log_x > 40)
        size = sum(np.abs(log) for log in logs)
        t = np.where(far, (log_x + np.exp(-log_x)) / k[0], t)
        error = np.where(far, (ELEMENTARY * (size + 1) + e_error) / k[0] + EPS * t, error)
    none, empty = tau == 0, np.multiply(medium.sigma_0, np.ones_like(t)) == 0
    escapes = empty | (~far & (x <= -1)) | np.isnan(t)
    unsure = ~empty & (k[0] < 0) & (np.abs(1 + x) <= np.abs(x) * relative)
    value = np.where(none, 0.0, np.where(escapes, np.inf, t))
    error = np.where(none | escapes, 0.0, error + TINY)
    return value, np.where(unsure & ~none, np.inf, error)


def _exponent(medium: ExponentialMedium, rays: Rays) -> tuple[Pair, Pair, np.ndarray, np.ndarray]:
    """Return e and k along each ray, and bounds of their errors."""
    e, k = dd.dot(medium.rate, rays.origin), dd.dot(medium.rate, rays.direction)
    shape = np.broadcast_shapes(e[0].shape, k[0].shape, np.shape(medium.sigma_0), rays.length.shape)
    e, k = (dd.each(lambda x: np.broadcast_to(x, shape), part) for part in (e, k))
    return e, k, dd.dot_error(medium.rate, rays.origin), dd.dot_error(medium.rate, rays.direction)


def squared(medium: ExponentialMedium) -> ExponentialMedium:
    """Return the medium with the extinction sigma_t^2."""
    sigma = np.asarray(medium.sigma_0) ** 2
    return ExponentialMedium(float(sigma) if sigma.ndim == 0 else tuple(sigma.tolist()), 2 * medium.rate)


def pieces(medium: ExponentialMedium, origin: np.ndarray, direction: np.ndarray, length: Any) -> list[Piece]:
    """Return the one piece of the ray."""
    rate, w = vector(medium.rate), vector(direction)
    source = rational(medium.albedo), rational(medium.emission)
    return _rising(rational(medium.sigma_0), dot(rate, vector(origin)), dot(rate, w), length, source)


def _rising(sigma_0: Any, e: Any, k: Any, s: Any, source: tuple[Any, Any]) -> list[Piece]:
    arb = flint().arb
    sigma = arb(e).exp() * sigma_0 if sigma_0 else flint().fmpq(0)
    if not sigma_0 or k == 0:
        return [constant(sigma, s, *source)]
    if s is not None:
        tau = sigma * (arb(k * s).expm1() / k)
    elif k < 0:
        tau = sigma / -k
    else:
        tau = arb.pos_inf()
    return [Piece(s, tau, *source, survived=lambda z: (-(sigma * ((z * k).exp() - 1) / k)).exp())]
