"""Rays seen from a light: the coordinates of the airlight integral from points in space, and what rounding makes of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.airlight_phase import AirlightPhase
from fogproof.analytic.error_free import EPS, two_sum
from fogproof.analytic.vectors import cross, dot, norm, product
from fogproof.scene import Ray


class Placement(NamedTuple):
    """Rays seen from a light, each (n,) unless said otherwise; lengths in metres, `x_low` is what x lacks.

    h, a, b      as in the airlight integral, length = b - a
    foot         (3, n) from the light to the nearest point of each line
    direction    (3, n) of the rays
    uncertainty  how far half a unit in the last place of the coordinates moves light and ray apart
    """

    h: np.ndarray
    h_low: np.ndarray
    a: np.ndarray
    a_low: np.ndarray
    b: np.ndarray
    length: np.ndarray
    foot: np.ndarray
    direction: np.ndarray
    uncertainty: np.ndarray

    @property
    def nearest(self) -> np.ndarray:
        """Distance of the light from each segment."""
        t = np.clip(0.0, self.a, self.b)
        return np.hypot(t, self.h)


def place(ray: Ray, position: tuple[float, float, float]) -> Placement:
    """Return the rays in the coordinates of a light at `position`, in about twice the precision of float64.

    The direction counts as d/|d|: h = |q x d| / |d| and a = -q.d / |d|, where q leads from the origin to the light.
    """
    light = np.array(position)[:, None]
    origin, d = ray.origin.reshape(-1, 3).T, ray.direction.reshape(-1, 3).T
    length = ray.length.ravel()
    q, q_low = two_sum(light, -origin)
    square, square_low = dot(d, np.zeros_like(d), d)
    excess = 0.5 * ((square - 1) + square_low)  # |d| - 1, for a direction that is off by rounding only
    h, h_low = norm(*cross(q, q_low, d))
    h, h_low = two_sum(h, h_low - h * excess)
    along, along_low = dot(q, q_low, d)
    a, a_low = two_sum(-along, along * excess - along_low)
    b, b_low = two_sum(a, length)
    b = b + np.where(np.isfinite(length), b_low + a_low, 0.0)
    ahead, ahead_low = product(along, d)
    foot = (ahead - q) + (ahead_low + along_low * d - 2 * excess * ahead - q_low)
    uncertainty = EPS * sum(np.sqrt(np.sum(x * x, axis=0)) for x in (origin, light, q, q))
    return Placement(h, h_low, a, a_low, b, length, foot, d, uncertainty)


def moved(where: Placement, sigma: np.ndarray, phase: AirlightPhase) -> tuple[np.ndarray, np.ndarray]:
    """Return what the uncertainty of the coordinates costs the airlight integral with `sigma` (n, channels).

    That is a bound of its relative error, and of a further error relative to the integral without phase function. A
    light moved by d changes path lengths by d at most, 1/r^2 by (1 - d/r)^-2, angles by d/r.
    """
    h, a, b, nearest = where.h, where.a, where.b, where.nearest
    with np.errstate(all="ignore"):
        turn = where.uncertainty / nearest
        low = np.where(b < np.inf, -b / np.hypot(b, h), -1.0)
        bend, steep = (x * turn for x in phase.slope(low, -a / np.hypot(a, h)))
        angular = 4 * EPS - 2 * np.log1p(-turn) + bend / (1 - bend)
        relative = np.expm1(2 * sigma * where.uncertainty[:, None] + angular[:, None])
    known = ((turn < 1) & (bend < 1))[:, None]
    return np.where(known, relative, np.inf), np.where(known, steep[:, None], np.inf)
