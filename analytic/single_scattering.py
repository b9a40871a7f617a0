"""Airlight along camera rays: radiance that one scattering sends from a light to the camera.

    L = sigma_s int_0^length exp(-sigma_t (t + r)) f_p(mu) I / r^2 dt        [W/(m^2 sr)]

with the distance r from the point at t to the light of intensity I [W/sr].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.airlight import Method, integrate
from fogproof.analytic.airlight_phase import airlight_phase
from fogproof.analytic.airlight_segments import Segments
from fogproof.analytic.error_free import EPS, TINY, two_sum
from fogproof.analytic.vectors import cross, dot, norm
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import Isotropic, Medium, PhaseFunction, PointLight, Ray
from fogproof.validate import channel_count


def single_scattering(medium: Medium, ray: Ray, light: PointLight, method: Method = "asinh") -> Reference:
    """Return the single-scattered radiance (airlight) along camera rays [W/(m^2 sr)].

    medium  homogeneous; it reaches at least as far as the ray and the light
    ray     rays of shape R; nothing stands between their points and the light
    light   a point light
    method  how the airlight integral is computed, see `airlight_integral`

    The result has shape R, or R + (C,) if medium or light have C channels. A light on the ray gives inf, a medium that
    does not scatter 0. `error` counts rounding, and half a unit in the last place of each coordinate of the origin,
    the direction and the light: a direction in float64 is no better than that, and neither is the answer.
    Source: Sun, Ramamoorthi, Narasimhan & Nayar 2005, A practical analytic single scattering model.
    """
    if not isinstance(medium, Medium):
        raise UnsupportedError(f"single scattering needs a homogeneous Medium, got {type(medium).__name__}", "medium")
    if not isinstance(light, PointLight):
        raise UnsupportedError(f"single scattering needs a PointLight, got {type(light).__name__}", "light")
    channels = channel_count(sigma_a=medium.sigma_a, sigma_s=medium.sigma_s, intensity=light.intensity)
    sigma, sigma_low = two_sum(medium.sigma_a, medium.sigma_s)
    with np.errstate(all="ignore"):
        geometry = place(ray, np.array(light.position))
        integral, error, name, source = _integrals(
            geometry, np.atleast_1d(sigma), np.atleast_1d(sigma_low), medium.phase, method
        )
        scale = np.atleast_1d(np.multiply(medium.sigma_s, light.intensity)) / (4 * np.pi)
        value = np.where(scale > 0, integral * scale, 0.0)
        error = np.where((scale > 0) & (value < np.inf), error * scale + 3 * EPS * value + TINY, 0.0)
    shape = ray.shape if channels is None else (*ray.shape, channels)
    return Reference(value.reshape(shape), error.reshape(shape), name, source)


class Geometry(NamedTuple):
    """Rays seen from a light, each (n,): `h`, `a`, `b`, `length` as in the airlight integral [m]; `x_low` extends x.

    uncertainty  how far half a unit in the last place of the coordinates moves light and ray apart [m]
    """

    h: np.ndarray
    h_low: np.ndarray
    a: np.ndarray
    a_low: np.ndarray
    b: np.ndarray
    length: np.ndarray
    uncertainty: np.ndarray


def place(ray: Ray, position: np.ndarray) -> Geometry:
    """Return the rays in the coordinates of a light at `position` (3,), in about twice the precision of float64.

    The direction counts as d/|d|: h = |q x d| / |d| and a = -q.d / |d|, where q leads from the origin to the light.
    """
    origin, d = ray.origin.reshape(-1, 3).T, ray.direction.reshape(-1, 3).T
    length = ray.length.ravel()
    q, q_low = two_sum(position[:, None], -origin)
    square, square_low = dot(d, np.zeros_like(d), d)
    excess = 0.5 * ((square - 1) + square_low)  # |d| - 1, for a direction that is off by rounding only
    h, h_low = norm(*cross(q, q_low, d))
    h, h_low = two_sum(h, h_low - h * excess)
    along, along_low = dot(q, q_low, d)
    a, a_low = two_sum(-along, along * excess - along_low)
    b, b_low = two_sum(a, length)
    b = b + np.where(np.isfinite(length), b_low + a_low, 0.0)
    uncertainty = EPS * sum(np.sqrt(np.sum(x * x, axis=0)) for x in (origin, position, q, q))
    return Geometry(h, h_low, a, a_low, b, length, uncertainty)


def _integrals(
    where: Geometry, sigma: np.ndarray, sigma_low: np.ndarray, phase: PhaseFunction, method: Method
) -> tuple[np.ndarray, np.ndarray, str, str]:
    """Return the airlight integrals (n, channels) and their error, what the coordinates are worth included."""
    h, h_low, a, a_low, b, length, uncertainty = (x[:, None] for x in where)
    fields = np.broadcast_arrays(sigma, sigma_low, h, h_low, a, a_low, a, b, length)
    value, error, name, source = integrate(Segments(*(x.ravel() for x in fields)), phase, method)
    value, error = value.reshape(fields[0].shape), error.reshape(fields[0].shape)

    # Move the light by d: path lengths change by d at most, 1/r^2 by (1 - d/r)^-2, angles by d/r.
    start, end = np.hypot(a, h), np.hypot(b, h)
    nearest = np.where(a > 0, start, np.where(b < 0, end, h))
    turn = uncertainty / nearest
    bend, steep = (x * turn for x in airlight_phase(phase).slope(np.where(b < np.inf, -b / end, -1.0), -a / start))
    relative = np.expm1(2 * sigma * uncertainty - 2 * np.log1p(-turn) + bend / (1 - bend))
    relative = np.where((turn < 1) & (bend < 1), relative, np.inf)
    plain = (
        integrate(Segments(*(x.ravel() for x in fields)), Isotropic())[0].reshape(value.shape) if steep.any() else 0.0
    )
    return value, np.where(np.isfinite(value), error + value * relative + plain * steep, 0.0), name, source
