"""Rays seen from a light: the coordinates of the airlight integral from points in space, and what rounding makes of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.arithmetic.vectors import (
    Pair,
    Split,
    cross,
    dot,
    hypot,
    norm,
    product_pair,
    root_pair,
    split,
    square,
    sum_pair,
)
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.scene import Ray


class Placement(NamedTuple):
    """Rays seen from a light, each (n,) unless said otherwise; lengths in metres, `x_low` is what x lacks.

    h, a, b      as in the airlight integral, length = b - a
    near         distance of the light from the camera
    q            (3, n) from the camera to the light
    direction    (3, n) of the rays, of length 1 + excess
    uncertainty  how far half a unit in the last place of the coordinates moves light and ray apart
    """

    h: np.ndarray
    h_low: np.ndarray
    a: np.ndarray
    a_low: np.ndarray
    b: np.ndarray
    length: np.ndarray
    near: np.ndarray
    near_low: np.ndarray
    q: np.ndarray
    q_low: np.ndarray
    direction: np.ndarray
    excess: np.ndarray
    uncertainty: np.ndarray

    @property
    def nearest(self) -> np.ndarray:
        """Distance of the light from each segment."""
        return hypot(np.maximum(np.maximum(self.a, -self.b), 0.0), self.h)


def place(ray: Ray | FlatRays, position: tuple[float, float, float], exact: bool = False) -> Placement:
    """Return the (flattened) rays in the coordinates of a light at `position`, in about twice the precision of float64.

    exact  the coordinates are meant as they stand: what is left of `uncertainty` is the rounding of this precision

    The direction counts as d/|d|: h = |q x d| / |d| and a = -q.d / |d|, where q leads from the origin to the light.
    """
    light = np.array(position)[:, None]
    origin, direction = (np.ascontiguousarray(x.reshape(-1, 3).T) for x in (ray.origin, ray.direction))
    length = ray.length.ravel()
    q, q_low = sum_pair(light, -origin)
    largest = np.max(np.abs(q), axis=0)
    extreme = bool(np.any((largest > 1e140) | ((largest < 1e-140) & (largest > 0))))
    exponent = np.frexp(largest)[1] if extreme else np.zeros(1, int)
    unit, unit_low = (np.ldexp(q, -exponent), np.ldexp(q_low, -exponent)) if extreme else (q, q_low)

    halves, d = split(unit), split(direction)
    square_d, square_d_low = dot(d, np.zeros_like(direction), d)
    excess = 0.5 * ((square_d - 1) + square_d_low)  # |d| - 1, for a direction that is off by rounding only
    along, along_low = dot(halves, unit_low, d)
    a, a_low = sum_pair(-along, along * excess - along_low)
    near2, near2_low = square(halves, unit_low)
    near, near_low = root_pair(near2, near2_low)
    h, h_low = _across(near2, near2_low, a, a_low)
    close = np.flatnonzero(h < 1e-5 * near)  # the difference of squares loses too much: by the cross product
    if len(close):
        some, some_d = ([Split(*(part[close] for part in x)) for x in v] for v in (halves, d))
        h[close], h_low[close] = norm(*cross(some, unit_low[:, close], some_d))
        h[close], h_low[close] = sum_pair(h[close], h_low[close] - h[close] * excess[close])
    if extreme:
        a, a_low, near, near_low, h, h_low = (np.ldexp(x, exponent) for x in (a, a_low, near, near_low, h, h_low))

    endless = np.isinf(length)
    b, b_low = sum_pair(a, np.where(endless, 0.0, length))
    b = np.where(endless, np.inf, b + (b_low + a_low))
    with np.errstate(over="ignore"):  # then the error is infinite, and says so
        size = np.abs(origin).sum(axis=0) + np.abs(light).sum() + 2 * np.abs(q).sum(axis=0)
    uncertainty = (64 * EPS * EPS if exact else EPS) * size
    return Placement(h, h_low, a, a_low, b, length, near, near_low, q, q_low, direction, excess, uncertainty)


def _across(near2: np.ndarray, near2_low: np.ndarray, a: np.ndarray, a_low: np.ndarray) -> Pair:
    """Return the pair of sqrt(near^2 - a^2)."""
    (halves,) = split([a])
    a2, a2_low = product_pair(halves, halves)
    h2, rest = sum_pair(near2, -a2)
    h2, rest = sum_pair(h2, rest + (near2_low - (a2_low + 2 * a * a_low)))
    return root_pair(np.maximum(h2, 0.0), np.where(h2 > 0, rest, 0.0))


def foot(where: Placement) -> np.ndarray:
    """Return the vectors (3, n) from the light to the nearest point of each line."""
    (ahead,) = split([-where.a])
    result = np.empty_like(where.q)
    for i, di in enumerate(split(where.direction)):
        part, rest = product_pair(ahead, di)
        result[i] = (part - where.q[i]) + (rest - where.a_low * di.value - where.excess * part - where.q_low[i])
    return result


def meets_light(where: Placement) -> np.ndarray:
    """Return which rays go through the light itself."""
    return (where.h == 0) & (where.a <= 0) & (where.b >= 0)


def moved(where: Placement, sigma: np.ndarray, phase: AirlightPhase) -> tuple[np.ndarray, np.ndarray]:
    """Return what the uncertainty of the coordinates costs the airlight integral with `sigma` (n, channels).

    That is a bound of its relative error, and of a further error relative to the integral without phase function. A
    light moved by d changes path lengths by d at most, 1/r^2 by (1 - d/r)^-2, angles by d/r.
    """
    h, a, b, nearest = where.h, where.a, where.b, where.nearest
    with np.errstate(all="ignore"):
        turn = where.uncertainty / nearest
        low = np.where(b < np.inf, -b / hypot(b, h), -1.0)
        bend, steep = (x * turn for x in phase.slope(low, -a / hypot(a, h)))
        angular = 4 * EPS - 2 * np.log1p(-turn) + bend / (1 - bend)
        relative = np.expm1(2 * sigma * where.uncertainty[:, None] + angular[:, None])
    known = ((turn < 1) & (bend < 1))[:, None]
    return np.where(known, relative, np.inf), np.where(known, steep[:, None], np.inf)
