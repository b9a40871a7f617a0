"""Optical thickness along any way through a medium, with what rounding makes of the shape that holds it."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.geometry.convex_shapes import size_of, through
from fogproof.analytic.media.coefficients import is_uniform
from fogproof.analytic.media.thickness import thickness
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.shapes import Shape


def attenuation(
    medium: AnyMedium, shape: Shape, x: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the optical thickness of the ways from x (m, 3) along unit vectors (m, 3), and its error, (m, channels) each.

    length  (m,) of the ways [m], may be inf
    """
    if not is_uniform(medium):
        tau = thickness(medium, Ray(x, direction, np.maximum(length, TINY)), medium.channels)
        channels = medium.channels or 1
        value = tau.value.reshape(-1, channels)
        error = tau.error.reshape(-1, channels) + 4 * EPS * value
        return value, np.where(np.isinf(value), 0.0, error)  # nothing arrives, for sure
    sigma = np.atleast_1d(medium.sigma_t)
    way, unsure = _way(shape, x, direction, length)
    value = _times(way, sigma)
    sure = np.isinf(value) & (unsure == 0)[:, None]  # nothing arrives then
    return value, np.where(sure, 0.0, _times(unsure, sigma) + 8 * EPS * value)


def _way(shape: Shape, x: np.ndarray, direction: np.ndarray, length: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the length of the ways in the shape, and by how much a shape a little smaller or larger changes it.

    The margin counts the rounding of the points, and of the directions along the ways.
    """

    def inside(margin: np.ndarray) -> np.ndarray:
        enter, leave = through(shape, x, direction, margin)
        return np.nan_to_num(np.maximum(np.minimum(leave, length) - np.maximum(enter, 0.0), 0.0), posinf=np.inf)

    way = inside(np.zeros(len(x)))
    margin = 16 * EPS * (np.abs(x).max(axis=1, initial=0.0) + size_of(shape))
    margin = margin + 8 * EPS * np.where(way < np.inf, way, 0.0)
    low, high = inside(-margin), inside(margin)
    return way, np.where(high > low, np.maximum(high - way, way - low), 0.0)


def _times(way: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    """Return way sigma (m, channels), 0 where there is no extinction."""
    return np.where(sigma > 0, way[:, None] * np.where(sigma > 0, sigma, 1.0), 0.0)
