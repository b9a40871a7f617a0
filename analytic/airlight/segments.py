"""The pieces of rays over which airlight is integrated, in the coordinates of the light."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.vectors import norm


class Segments(NamedTuple):
    """Pieces [start, end] of rays whose cameras are at a, all (n,).

    `x_low` is what the rounded x lacks; it matters for the attenuation over many mean free paths. `near` is the distance of
    the light from the start, `length` is end - start, more accurate than the difference where the caller knows better.
    """

    sigma: np.ndarray
    sigma_low: np.ndarray
    h: np.ndarray
    h_low: np.ndarray
    a: np.ndarray
    a_low: np.ndarray
    start: np.ndarray
    end: np.ndarray
    length: np.ndarray
    near: np.ndarray
    near_low: np.ndarray


def whole(sigma: np.ndarray, h: np.ndarray, a: np.ndarray, b: np.ndarray) -> Segments:
    """Return rays from the camera at a to b, all numbers exact."""
    zero = np.zeros(h.shape)
    return Segments(sigma, zero, h, zero, a, zero, a, b, b - a, *norm((a, h), (zero, zero)))


def cut(segments: Segments, places: np.ndarray) -> tuple[Segments, np.ndarray]:
    """Return the segments cut at `places` (n, m), and which of the n each piece (in order) comes from.

    A place outside its segment, or NaN, does not cut.
    """
    start, end = segments.start[:, None], segments.end[:, None]
    inside = np.where((places > start) & (places < end), places, start)
    edges = np.concatenate([start, np.sort(inside, axis=1), end], axis=1)
    owner, k = np.nonzero(edges[:, 1:] > edges[:, :-1])
    low, high = edges[owner, k], edges[owner, k + 1]
    pieces = Segments(*(x[owner] for x in segments))
    uncut = (low == pieces.start) & (high == pieces.end)
    near, near_low = norm((low, pieces.h), (np.where(low == pieces.a, pieces.a_low, 0.0), pieces.h_low))
    length = np.where(uncut, pieces.length, high - low)
    return pieces._replace(start=low, end=high, length=length, near=near, near_low=near_low), owner
